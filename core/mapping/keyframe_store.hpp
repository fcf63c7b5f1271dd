#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/mapping/cloud_pool.hpp"
#include "core/mapping/keyframe.hpp"

namespace slamd::mapping {

/// The keyframes along the way, in the order of their ids, with their clouds. Indices change when one is taken out.
///
/// At the limit: the caller takes one out first (`most_redundant`); add() refuses where there is no room.
/// Memory: sized once.
class KeyframeStore {
 public:
  KeyframeStore(std::size_t capacity, std::size_t points_a_cloud);

  /// Appends a keyframe with its cloud (in `level`). Returns false where the store is full.
  bool add(Keyframe keyframe, std::span<const Eigen::Vector3f> points_level);

  /// Takes a keyframe out; those after it move up.
  void erase(std::size_t i);

  void clear();

  std::size_t size() const { return keyframes_.size(); }
  bool empty() const { return keyframes_.empty(); }
  bool full() const { return keyframes_.full(); }
  const Keyframe& operator[](std::size_t i) const { return keyframes_[i]; }
  /// Returns where a keyframe stands; size() if it is not there.
  std::size_t index_of(graph::KeyframeId id) const;
  const Keyframe& back() const { return keyframes_.back(); }
  std::size_t cloud_points(std::size_t i) const { return clouds_.points(keyframes_[i].cloud); }
  std::size_t points_a_cloud() const { return clouds_.points_a_slot(); }

  /// Appends a keyframe's cloud, taken from `level` by R and t, as far as there is room.
  void append_cloud(std::size_t i, const geometry::Se3& T_out_level, BoundedVector<Eigen::Vector3f>& out) const;

  /// Returns the keyframe that the map misses least: of the two that lie nearest to each other, look the same way (within
  /// 45°) and are not the first one nor among the last `kept`, the older. Where no two lie within 10 m: the oldest but the
  /// first. T_map_base is asked for by index. Nothing where no keyframe may go.
  /// O(n log n), and n times the neighbours within 10 m.
  template <typename PoseOf>
  std::optional<std::size_t> most_redundant(std::size_t kept, PoseOf&& T_map_base) {
    placed_.clear();
    for (std::size_t i = 0; i < size(); ++i) {
      const geometry::Se3& T = T_map_base(i);
      placed_.push_back({T.translation(), T.rotation().col(0), i});
    }
    return most_redundant_placed(kept);
  }

 private:
  struct Placed {
    Eigen::Vector3d p_map;
    Eigen::Vector3d ahead_map;
    std::size_t index;
  };

  std::optional<std::size_t> most_redundant_placed(std::size_t kept);

  BoundedVector<Keyframe> keyframes_;
  CloudPool clouds_;
  BoundedVector<Placed> placed_;  // scratch, sized once
};

}  // namespace slamd::mapping
