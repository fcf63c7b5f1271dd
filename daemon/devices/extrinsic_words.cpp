#include "daemon/devices/extrinsic_words.hpp"

#include <cmath>

#include "core/base/units.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::devices {

namespace {

constexpr double kSame_m = 1e-3;  // what is stored is in whole millimetres
constexpr double kSame_rad = 0.1 * kDegree;

geometry::Se3 transform_of(const livox::Sdk1Extrinsic& stored) {
  Eigen::Vector3d xyz_m;
  Eigen::Vector3d rpy_rad;
  for (int axis = 0; axis < 3; ++axis) {
    xyz_m[axis] = 1e-3 * stored.xyz_mm[static_cast<std::size_t>(axis)];
    rpy_rad[axis] = kDegree * static_cast<double>(stored.rpy_deg[static_cast<std::size_t>(axis)]);
  }
  return {geometry::rotation_from_rpy(rpy_rad), xyz_m};
}

}  // namespace

std::string extrinsic_remark(const livox::Sdk1Extrinsic& stored, const geometry::Se3& T_base_lidar) {
  if (stored == livox::Sdk1Extrinsic{}) {
    return {};
  }
  const geometry::Se3 T_stored = transform_of(stored);
  const bool same = (T_stored.translation() - T_base_lidar.translation()).norm() <= kSame_m &&
                    geometry::angle_between(T_stored.rotation(), T_base_lidar.rotation()) <= kSame_rad;
  return same ? "it is what lidar.T_base_lidar says, which slamd applies, once"
              : "it is not what lidar.T_base_lidar says, and slamd ignores it: only lidar.T_base_lidar is applied";
}

}  // namespace slamd::devices
