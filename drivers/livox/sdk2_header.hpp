#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/stamp.hpp"

namespace slamd::livox {

/// Whose time an SDK2 packet's stamp tells; always a count of nanoseconds. Source: livox-sdk2.md §4.
enum class Sdk2TimeType : std::uint8_t {
  kFreeRunning = 0,  // since boot
  kPtp = 1,          // the PTP or gPTP master's epoch
  kGps = 2,          // UTC from PPS and GPRMC
};

/// The 36 bytes in front of the points or the inertial sample. Source: livox-sdk2.md §4.
struct Sdk2Header {
  static constexpr std::size_t kBytes = 36;
  static constexpr std::size_t kChecked = 28;  // where that begins which the checksum covers
  static constexpr std::uint8_t kVersion = 0;

  std::uint8_t version = kVersion;
  std::uint16_t length = 0;               // of the whole datagram
  std::uint16_t time_interval_100ns = 0;  // from the first point to the last
  std::uint16_t points = 0;               // firings; 1 for an inertial sample
  std::uint16_t number = 0;               // one more than in the stream's last packet
  std::uint8_t frame = 0;                 // of no meaning while the scan pattern does not repeat
  std::uint8_t data_type = 0;
  std::uint8_t time_type = 0;
  std::uint32_t checksum = 0;
  std::uint64_t timestamp_ns = 0;  // of the first point
};

/// Reads the header. The caller has checked that kBytes are there.
Sdk2Header parse_sdk2_header(std::span<const std::byte> payload);

/// Writes a header in front of a packet whose data are there already: length and checksum are
/// computed, the header's own are not looked at. The caller has checked that kBytes are there.
void seal_sdk2_packet(const Sdk2Header& header, std::span<std::byte> packet);

/// Returns the checksum that the packet should carry.
std::uint32_t sdk2_checksum(std::span<const std::byte> packet);

/// Returns the type when the protocol defines it.
std::optional<Sdk2TimeType> sdk2_time_type_of(std::uint8_t raw);

}  // namespace slamd::livox
