#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/graph_ids.hpp"

namespace slamd::mapping {

/// A stretch of the way whose map moves as one. What a client holds of it stays where it is in the submap; only
/// T_map_submap changes.
/// Frames: T_odom_submap is a translation by whole blocks, fixed for life.
struct Submap {
  std::uint32_t id = 0;
  std::uint32_t version = 0;  // +1 with each change of T_map_submap
  std::uint32_t keyframes = 0;  // that still belong to it
  graph::KeyframeId first_keyframe = 0;
  double begin_path_m = 0.0;
  Eigen::Vector3d anchor_odom = Eigen::Vector3d::Zero();
  geometry::Se3 T_map_submap;

  geometry::Se3 T_odom_submap() const { return {Eigen::Matrix3d::Identity(), anchor_odom}; }
};

/// The submaps, in the order of their ids. One lives as long as a keyframe belongs to it, so that there are never more than
/// keyframes.
/// Memory: sized once.
class Submaps {
 public:
  /// Side of a block of 8 × 8 × 8 cells of 0.2 m, by which anchors lie on a grid.
  static constexpr double kBlock_m = 1.6;

  Submaps(std::size_t capacity, double length_m) : length_m_(length_m), submaps_(capacity) {}

  /// Takes a keyframe in: into the newest submap, or into a new one where that is length_m long. Returns the submap's id.
  std::uint32_t add_keyframe(graph::KeyframeId id, double path_m, const geometry::Se3& T_odom_base, const geometry::Se3& T_map_odom);

  /// Tells that a keyframe was taken out.
  void remove_keyframe(std::uint32_t submap);

  /// Sets where a submap lies, T_map_odom being the correction there; a change counts up its version. Returns whether
  /// it changed.
  bool place(std::size_t i, const geometry::Se3& T_map_odom);

  void clear();

  std::span<const Submap> view() const { return submaps_.view(); }
  std::size_t size() const { return submaps_.size(); }
  const Submap& operator[](std::size_t i) const { return submaps_[i]; }

 private:
  double length_m_;
  std::uint32_t next_id_ = 0;
  BoundedVector<Submap> submaps_;
};

}  // namespace slamd::mapping
