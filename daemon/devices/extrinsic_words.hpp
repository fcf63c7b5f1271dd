#pragma once

#include <string>

#include "core/geometry/se3.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::devices {

/// Says what becomes of an extrinsic that a device has stored: devices only keep it (livox-sdk1.md §4), and slamd goes by
/// T_base_lidar alone, so that no point is moved twice. Empty where none is stored.
std::string extrinsic_remark(const livox::Sdk1Extrinsic& stored, const geometry::Se3& T_base_lidar);

}  // namespace slamd::devices
