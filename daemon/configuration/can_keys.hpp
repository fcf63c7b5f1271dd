#pragma once

#include <vector>

#include "daemon/configuration/key_table.hpp"

namespace slamd::configuration {

/// Adds the keys of an inertial sensor on a CAN bus: of table imu.
void add_imu_can_keys(std::vector<Key>& keys);

/// Adds the keys of wheels on a CAN bus: of table wheel.
void add_wheel_can_keys(std::vector<Key>& keys);

}  // namespace slamd::configuration
