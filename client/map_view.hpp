#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/stamp.hpp"
#include "core/occupancy/queries.hpp"
#include "core/occupancy/state_map.hpp"

namespace slamd::client {

/// Where a submap lies, as told last.
struct SubmapPlace {
  std::int32_t id = 0;
  std::uint32_t version = 0;
  Eigen::Vector3d anchor_odom = Eigen::Vector3d::Zero();
  Eigen::Isometry3d T_map_submap = Eigen::Isometry3d::Identity();

  /// Takes a point of the submap from where odom had it to where it lies in map now.
  Eigen::Vector3d to_map(const Eigen::Vector3d& p_odom) const { return T_map_submap * Eigen::Vector3d(p_odom - anchor_odom); }
};

/// The map around the robot at one moment: it does not change while it is looked at.
/// Frames: odom, but for to_map().
/// Threads: any; nothing here waits or allocates.
class MapView {
 public:
  using CellState = occupancy::CellState;

  /// Whether there is a map.
  bool known() const { return map_id_ != 0; }

  /// Whether it was the daemon's, block by block, when the newest message was made.
  bool complete() const { return complete_; }

  /// Of the scan that it was last changed by.
  Stamp stamp() const { return stamp_; }

  /// Another one: forget what was derived from the map.
  std::int64_t map_id() const { return map_id_; }

  /// The cells themselves, for planners that walk through them.
  const occupancy::StateMap& cells() const { return map_; }

  CellState at(const Eigen::Vector3d& p_odom) const { return occupancy::state_at(map_, p_odom); }

  /// Whether the block around a point is as the daemon had it when the newest message was made.
  bool is_current(const Eigen::Vector3d& p_odom) const;

  occupancy::CellCounts count(const Eigen::Vector3d& min_odom, const Eigen::Vector3d& max_odom) const { return occupancy::count_cells(map_, min_odom, max_odom); }

  /// The first cell on the way that is occupied, or unknown where `unknown_blocks`; nothing: the way is clear.
  std::optional<occupancy::RayHit> cast(const Eigen::Vector3d& from_odom, const Eigen::Vector3d& to_odom, bool unknown_blocks = true) const {
    return occupancy::cast_ray(map_, from_odom, to_odom, unknown_blocks);
  }

  std::optional<occupancy::Obstacle> nearest(const Eigen::Vector3d& p_odom, double radius_m) const { return occupancy::nearest_obstacle(map_, p_odom, radius_m); }

  /// Where odom lies in map, as told last.
  const Eigen::Isometry3d& T_map_odom() const { return T_map_odom_; }

  /// Returns where a point lies in map: by the submap of its block, or by T_map_odom where that is not known.
  Eigen::Vector3d to_map(const Eigen::Vector3d& p_odom) const;

  /// All submaps of this odom, by id.
  const std::vector<SubmapPlace>& submaps() const { return submaps_; }

  /// Returns a submap, or nullptr.
  const SubmapPlace* submap(std::int32_t id) const;

 private:
  friend class MapClient;

  std::int64_t map_id_ = 0;
  std::uint64_t copy_ = 0;  // that numbers_ are of
  bool complete_ = false;
  Stamp stamp_{};
  occupancy::StateMap map_;
  std::vector<std::uint64_t> numbers_;  // per slot: of the change that was copied
  std::vector<std::int32_t> block_submaps_;
  std::uint64_t current_from_ = 0;      // blocks of this number and above are current
  Eigen::Isometry3d T_map_odom_ = Eigen::Isometry3d::Identity();
  std::vector<SubmapPlace> submaps_;
};

}  // namespace slamd::client
