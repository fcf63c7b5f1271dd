#include "core/mapping/submaps.hpp"

#include <cmath>

#include "core/base/assert.hpp"

namespace slamd::mapping {

using geometry::Se3;

namespace {

/// Less is no change.
constexpr double kUnmoved_m = 1e-4;
constexpr double kUnmoved_rad = 1e-5;

}  // namespace

std::uint32_t Submaps::add_keyframe(graph::KeyframeId id, double path_m, const Se3& T_odom_base, const Se3& T_map_odom) {
  if (submaps_.empty() || path_m - submaps_.back().begin_path_m >= length_m_) {
    SLAMD_ASSERT(!submaps_.full());
    Submap submap;
    submap.id = next_id_++;
    submap.first_keyframe = id;
    submap.begin_path_m = path_m;
    submap.anchor_odom = (T_odom_base.translation() / kBlock_m).array().round() * kBlock_m;
    submap.T_map_submap = T_map_odom * submap.T_odom_submap();
    submaps_.push_back(submap);
  }
  ++submaps_.back().keyframes;
  return submaps_.back().id;
}

void Submaps::remove_keyframe(std::uint32_t submap) {
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    if (submaps_[i].id != submap) {
      continue;
    }
    if (--submaps_[i].keyframes == 0) {
      for (std::size_t k = i + 1; k < submaps_.size(); ++k) {
        submaps_[k - 1] = submaps_[k];
      }
      submaps_.resize(submaps_.size() - 1);
    }
    return;
  }
}

bool Submaps::place(std::size_t i, const Se3& T_map_odom) {
  Submap& submap = submaps_[i];
  const Se3 T_map_submap = T_map_odom * submap.T_odom_submap();
  const geometry::Vector6d change = geometry::boxminus(T_map_submap, submap.T_map_submap);
  if (change.head<3>().norm() < kUnmoved_m && change.tail<3>().norm() < kUnmoved_rad) {
    return false;
  }
  submap.T_map_submap = T_map_submap;
  ++submap.version;
  return true;
}

void Submaps::clear() { submaps_.clear(); }

}  // namespace slamd::mapping
