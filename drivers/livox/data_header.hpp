#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/stamp.hpp"

namespace slamd::livox {

/// Whose time a packet's stamp tells. Source: livox-sdk1.md §5.2.
enum class TimestampType : std::uint8_t {
  kFreeRunning = 0,  // since power-up
  kPtp = 1,          // the PTP master's epoch
  kGps = 3,          // UTC from PPS and GPRMC: DeviceStamp counts from 1970
  kPps = 4,          // since the last PPS edge: the ClockModel's roll_over is kPpsRollOver
};

inline constexpr Duration kPpsRollOver = std::chrono::seconds{1};

/// The 18 bytes in front of the points or the inertial sample.
struct DataHeader {
  static constexpr std::size_t kBytes = 18;
  static constexpr std::uint8_t kVersion = 5;

  std::uint8_t version = 0;
  std::uint8_t slot = 0;
  std::uint8_t lidar_id = 0;
  std::uint32_t status_code = 0;
  std::uint8_t timestamp_type = 0;
  std::uint8_t data_type = 0;
};

/// Reads the header's fields but the time. The caller has checked that kBytes are there.
DataHeader parse_header(std::span<const std::byte> payload);

/// Returns the type when the protocol defines it.
std::optional<TimestampType> timestamp_type_of(std::uint8_t raw);

/// Reads the header's 8 time bytes.
/// Errors: nothing for a date that is none, an hour longer than 3,601 s (a leap second), PPS time
/// of 2 s or more (the edge before was missed), and counters beyond 63 bits.
std::optional<DeviceStamp> parse_device_stamp(std::span<const std::byte> payload,
                                              TimestampType type);

}  // namespace slamd::livox
