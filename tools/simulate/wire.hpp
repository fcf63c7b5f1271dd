#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/stamp.hpp"

namespace slamd::simulate {

/// What a datagram holds, by its bytes.
enum class Wire : std::uint8_t {
  kVelodyneData,
  kVelodynePosition,
  kLivoxPoints,
  kLivoxImu,
  kLivox2Points,
  kLivox2Imu,
  kOther
};

inline constexpr std::size_t kWires = 7;

const char* name_of(Wire wire);

Wire wire_of(std::span<const std::byte> payload);

bool is_points(Wire wire);
bool is_imu(Wire wire);

/// Turns the device's clock on. Stamps that count from the top of the hour stay below an hour.
void shift_clock(std::span<std::byte> payload, Wire wire, Duration by);

/// A sector of azimuths, counter-clockwise from x ahead; from > to passes through 180°.
struct Sector {
  double from_deg = 0.0;
  double to_deg = 0.0;

  bool contains(double azimuth_deg) const;
};

/// Makes the returns in a sector empty ones, as a mast in front of the sensor does; returns how many there were.
std::uint64_t block_sector(std::span<std::byte> payload, Wire wire, const Sector& sector);

/// The most that an inertial sensor can say.
struct InertialLimits {
  double rate_radps = 0.0;
  double force_mps2 = 0.0;
};

/// Cuts a packet's inertial sample to limits; returns whether anything was cut.
bool clip_imu(std::span<std::byte> payload, Wire wire, const InertialLimits& limits);

}  // namespace slamd::simulate
