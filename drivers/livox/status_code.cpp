#include "drivers/livox/status_code.hpp"

#include <algorithm>

namespace slamd::livox {

namespace {

std::uint32_t bits(std::uint32_t code, int first, int count) {
  return (code >> first) & ((1U << count) - 1U);
}

Severity severity(std::uint32_t code, int first) {
  return static_cast<Severity>(bits(code, first, 2));
}

std::string_view worded(Severity severity,
                        std::string_view warning,
                        std::string_view error,
                        std::string_view reserved) {
  switch (severity) {
    case Severity::kNormal:
      return {};
    case Severity::kWarning:
      return warning;
    case Severity::kError:
      return error;
    case Severity::kReserved:
      return reserved;
  }
  return reserved;
}

}  // namespace

StatusCode parse_status_code(std::uint32_t code) {
  constexpr auto kLastSync = static_cast<std::uint32_t>(TimeSync::kReserved);
  StatusCode status;
  status.temperature = severity(code, 0);
  status.voltage = severity(code, 2);
  status.motor = severity(code, 4);
  status.window_dirty = bits(code, 6, 2) != 0;
  status.firmware_error = bits(code, 8, 1) != 0;
  status.pps_present = bits(code, 9, 1) != 0;
  status.end_of_life_warning = bits(code, 10, 1) != 0;
  status.fan_warning = bits(code, 11, 1) != 0;
  status.self_heating = bits(code, 12, 1) != 0;
  status.ptp_ok = bits(code, 13, 1) != 0;
  status.time_sync = static_cast<TimeSync>(std::min(bits(code, 14, 3), kLastSync));
  status.system = severity(code, 30);
  return status;
}

FixedVector<std::string_view, 9> concerns_of(const StatusCode& status) {
  FixedVector<std::string_view, 9> concerns;
  const auto add = [&concerns](std::string_view words) {
    if (!words.empty()) {
      concerns.push_back(words);
    }
  };
  add(worded(status.temperature,
             "temperature high or low",
             "temperature extreme",
             "temperature state unknown"));
  add(worded(status.voltage, "voltage high or low", "voltage extreme", "voltage state unknown"));
  add(worded(status.motor, "motor warning", "motor error", "motor state unknown"));
  add(worded(status.system, "system warning", "system error", "system state unknown"));
  add(status.window_dirty ? "window dirty or blocked" : "");
  add(status.firmware_error ? "firmware error" : "");
  add(status.end_of_life_warning ? "device near its end of life" : "");
  add(status.fan_warning ? "fan warning" : "");
  add(status.time_sync == TimeSync::kAbnormal ? "time synchronisation abnormal" : "");
  return concerns;
}

std::string_view name_of(TimeSync sync) {
  switch (sync) {
    case TimeSync::kNone:
      return "none";
    case TimeSync::kPtp:
      return "ptp";
    case TimeSync::kGps:
      return "gps";
    case TimeSync::kPps:
      return "pps";
    case TimeSync::kAbnormal:
      return "abnormal";
    case TimeSync::kReserved:
      return "reserved";
  }
  return "reserved";
}

}  // namespace slamd::livox
