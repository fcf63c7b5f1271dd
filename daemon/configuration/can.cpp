#include "daemon/configuration/can.hpp"

#include <string>

#include "core/base/assert.hpp"
#include "drivers/can/aceinna_imu.hpp"

namespace slamd::configuration {

namespace {

constexpr std::size_t kLongestInterface = 15;
constexpr std::uint32_t kHighestShortId = 0x7FF;

std::string quoted(const std::string& text) { return '"' + text + '"'; }

/// A signal and the names of its keys.
struct NamedSignal {
  const char* table;
  const char* id;
  const char* first_bit;
  const char* scale;
  const std::optional<can::CanSignal>& signal;
};

std::optional<DeviceFault> interface_fault(const char* path, const std::string& interface, bool is_live) {
  if (interface.size() > kLongestInterface || interface.find_first_of("/ \t\n") != std::string::npos) {
    return DeviceFault{path, quoted(interface), "must be the name of a network interface, up to 15 characters"};
  }
  if (is_live && interface.empty()) {
    return DeviceFault{path, "", "is needed by source = \"can\": the interface, such as \"can0\""};
  }
  return std::nullopt;
}

std::optional<DeviceFault> imu_fault(const ImuConfiguration& imu) {
  const bool is_aceinna = imu.protocol == imu::Protocol::kAceinna;
  if (!imu.is_on_can()) {
    return is_aceinna ? std::optional(DeviceFault{"imu.protocol", "\"aceinna\"", "is for imu.source = \"can\", or a candump log"})
                      : std::nullopt;
  }
  if (imu.protocol != imu::Protocol::kXsens && !is_aceinna) {
    return DeviceFault{"imu.protocol", quoted(name_of(imu.protocol)), "is not spoken on CAN; must be \"xsens\" or \"aceinna\""};
  }
  if (imu.rate_hz != 0) {
    return DeviceFault{"imu.rate_hz", std::to_string(imu.rate_hz), "slamd only listens on CAN; must be 0"};
  }
  if (!can::parse_axis_map(imu.axis_map)) {
    return DeviceFault{"imu.axis_map", quoted(imu.axis_map), "must name x, y and z once each, such as \"y,x,z\" or \"y,x,-z\""};
  }
  return interface_fault("imu.interface", imu.interface, imu.source == "can");
}

std::optional<DeviceFault> signal_fault(const NamedSignal& named) {
  if (!named.signal) {
    return DeviceFault{named.table, "", "is needed on CAN: { id = ..., first_bit = ..., bits = ..., scale = ... }"};
  }
  const can::CanSignal& signal = *named.signal;
  if (!signal.is_extended && signal.id > kHighestShortId) {
    return DeviceFault{named.id, std::to_string(signal.id), "has more than 11 bits, which needs extended = true"};
  }
  if (signal.scale == 0.0) {
    return DeviceFault{named.scale, "0.0", "must not be 0"};
  }
  if (!signal.is_valid()) {
    return DeviceFault{named.first_bit, std::to_string(signal.first_bit),
                       "with this byte order and number of bits lies outside of a frame of 8 bytes"};
  }
  return std::nullopt;
}

std::optional<DeviceFault> wheel_fault(const WheelConfiguration& wheel) {
  const bool is_ackermann = wheel.model == can::WheelModel::kAckermann;
  const NamedSignal signals[] = {
      {"wheel.left", "wheel.left.id", "wheel.left.first_bit", "wheel.left.scale", wheel.left},
      {"wheel.right", "wheel.right.id", "wheel.right.first_bit", "wheel.right.scale", wheel.right},
      {"wheel.speed", "wheel.speed.id", "wheel.speed.first_bit", "wheel.speed.scale", wheel.speed},
      {"wheel.steering", "wheel.steering.id", "wheel.steering.first_bit", "wheel.steering.scale", wheel.steering}};
  for (std::size_t i = 0; i < std::size(signals); ++i) {
    if ((i >= 2) != is_ackermann) {
      continue;
    }
    if (const auto fault = signal_fault(signals[i])) {
      return fault;
    }
  }
  return interface_fault("wheel.interface", wheel.interface, wheel.source == "can");
}

}  // namespace

std::optional<DeviceFault> can_fault(const Configuration& configuration) {
  if (configuration.imu.enabled) {
    if (const auto fault = imu_fault(configuration.imu)) {
      return fault;
    }
  }
  return configuration.wheel.use && configuration.wheel.is_on_can() ? wheel_fault(configuration.wheel) : std::nullopt;
}

can::WheelSignals wheel_signals(const WheelConfiguration& wheel) {
  const bool is_ackermann = wheel.model == can::WheelModel::kAckermann;
  const std::optional<can::CanSignal>& first = is_ackermann ? wheel.speed : wheel.left;
  const std::optional<can::CanSignal>& second = is_ackermann ? wheel.steering : wheel.right;
  SLAMD_ASSERT(first && second);
  return {wheel.model, {*first, *second}, is_ackermann ? wheel.wheelbase_m : wheel.track_m};
}

}  // namespace slamd::configuration
