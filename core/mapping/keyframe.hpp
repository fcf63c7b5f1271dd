#pragma once

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/graph_ids.hpp"
#include "core/mapping/cloud_pool.hpp"

namespace slamd::mapping {

/// A place that the map remembers: a scan's pose and what was seen from there and from the way right behind it.
/// Frames: the cloud is in `level`: origin and heading of base, its z axis up.
struct Keyframe {
  graph::KeyframeId id = 0;
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  Eigen::Matrix3d R_base_level = Eigen::Matrix3d::Identity();
  double path_m = 0.0;       // driven until there
  double median_range_m = 0.0;  // of the cloud
  CloudSlot cloud = kNoCloud;
  std::uint32_t submap = 0;
};

/// Returns the rotation from `level` to base where base points up_base upwards: no turn about the vertical.
Eigen::Matrix3d level_of(const Eigen::Vector3d& up_base);

}  // namespace slamd::mapping
