#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace slamd::livox {

/// What became of a datagram; all but the first two are refusals.
enum class DecodeResult : std::uint8_t {
  kPoints,
  kImu,
  kControlFrame,      // a command or its answer (0xAA): right protocol, wrong port
  kTooShort,          // no room for the header
  kUnknownVersion,    // not the protocol's: 5 in SDK1, 0 in SDK2
  kUnknownDataType,   // not one that the protocol defines
  kWrongLength,       // not what the header and the data type ask for
  kBadTimestampType,  // reserved
  kBadTimestamp,      // no date, or out of range
  kBadImu,            // infinite or not a number
  kBadChecksum,       // SDK2 only: damaged on its way
};

inline constexpr std::size_t kDecodeResults = 11;

/// Names a result as reports and health spell it.
std::string_view name_of(DecodeResult result);

struct LivoxCounters {
  std::array<std::uint64_t, kDecodeResults> packets{};  // by DecodeResult
  std::uint64_t points = 0;                             // given out
  std::uint64_t empty_firings = 0;                      // without any return
  std::uint64_t out_of_range = 0;                       // returns outside the range gate
  std::uint64_t bad_angles = 0;                         // spherical returns beyond 180° or 360°

  std::uint64_t of(DecodeResult result) const { return packets[static_cast<std::size_t>(result)]; }
};

}  // namespace slamd::livox
