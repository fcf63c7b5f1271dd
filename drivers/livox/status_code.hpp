#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/fixed_vector.hpp"

namespace slamd::livox {

/// How bad a monitored quantity is; kReserved is a value that the protocol does not define.
enum class Severity : std::uint8_t { kNormal, kWarning, kError, kReserved };

/// What the device says it is synchronised to.
enum class TimeSync : std::uint8_t { kNone, kPtp, kGps, kPps, kAbnormal, kReserved };

/// The status code of data packets and of the abnormal-status push, bit by bit.
/// Source: livox-sdk1.md §5.1.
struct StatusCode {
  Severity temperature = Severity::kNormal;  // too high or too low; kError: extreme
  Severity voltage = Severity::kNormal;
  Severity motor = Severity::kNormal;
  Severity system = Severity::kNormal;
  TimeSync time_sync = TimeSync::kNone;
  bool window_dirty = false;  // dirty or blocked
  bool firmware_error = false;
  bool pps_present = false;
  bool end_of_life_warning = false;
  bool fan_warning = false;
  bool self_heating = false;
  bool ptp_ok = false;
};

/// Takes a status code apart. Any 32 bits are accepted; reserved bits are ignored.
StatusCode parse_status_code(std::uint32_t code);

/// Names what a user should look after, in words for the health report; empty when all is well.
/// Real-time: no allocation.
FixedVector<std::string_view, 9> concerns_of(const StatusCode& status);

std::string_view name_of(TimeSync sync);

}  // namespace slamd::livox
