#pragma once

#include <cstdint>

#include "core/geometry/se3.hpp"
#include "core/geometry/so3.hpp"
#include "daemon/bus/messages.hpp"

namespace slamd::pipeline {

/// Where a command has put the map as mapping corrects it, in map. Plain numbers, so that it passes through Latest.
struct MapPlacement {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;
  std::uint32_t correction_id = 0;  // counts the commands
  bus::Correction cause = bus::Correction::kStart;

  geometry::Se3 T_map_corrected() const {
    return {geometry::rotation_from_rpy({0.0, 0.0, yaw_rad}), Eigen::Vector3d(x_m, y_m, z_m)};
  }
};

/// Where mapping has odom in the map that it corrects. Plain numbers, so that it passes through Latest.
struct MapCorrection {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double quaternion_xyzw[4] = {0.0, 0.0, 0.0, 1.0};
  std::uint32_t correction_id = 0;  // counts mapping's corrections
  std::uint32_t epoch = 0;          // of the odom that it places

  static MapCorrection of(const geometry::Se3& T_corrected_odom, std::uint32_t correction_id, std::uint32_t epoch) {
    MapCorrection correction;
    correction.x_m = T_corrected_odom.translation().x();
    correction.y_m = T_corrected_odom.translation().y();
    correction.z_m = T_corrected_odom.translation().z();
    Eigen::Vector4d::Map(correction.quaternion_xyzw) = T_corrected_odom.quaternion().coeffs();
    correction.correction_id = correction_id;
    correction.epoch = epoch;
    return correction;
  }

  /// Returns where the odom of an epoch lies: one that mapping has not seen yet is the map.
  geometry::Se3 T_corrected_odom(std::uint32_t of_epoch) const {
    if (of_epoch != epoch) {
      return {};
    }
    return {Eigen::Quaterniond(Eigen::Vector4d::Map(quaternion_xyzw)), Eigen::Vector3d(x_m, y_m, z_m)};
  }
};

}  // namespace slamd::pipeline
