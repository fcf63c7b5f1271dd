#pragma once

#include <optional>

#include "daemon/configuration/configuration.hpp"
#include "daemon/configuration/device.hpp"

namespace slamd::configuration {

/// Finds the first fault of what is said about sensors on a CAN bus, beyond what each key can tell; nothing: there is none.
std::optional<DeviceFault> can_fault(const Configuration& configuration);

/// Returns where the wheels' numbers are on the bus.
/// Errors: programmer error unless the wheels are on CAN and can_fault() finds nothing.
can::WheelSignals wheel_signals(const WheelConfiguration& wheel);

}  // namespace slamd::configuration
