#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "client/map_view.hpp"
#include "daemon/bus/messages.hpp"

namespace slamd::client {

inline Eigen::Isometry3d isometry_of(const geometry::Se3& T) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = T.rotation();
  out.translation() = T.translation();
  return out;
}

/// Puts the chunks of SLAMD_SUBMAP_POSES together.
class SubmapTable {
 public:
  /// Returns whether the table is a new one now.
  bool add(const bus::SubmapPoses& chunk) {
    if (chunk.stamp != stamp_ || chunk.count != missing_.size()) {
      if (chunk.stamp < stamp_ && chunk.epoch == epoch_) {
        return false;
      }
      stamp_ = chunk.stamp;
      epoch_ = chunk.epoch;
      coming_.clear();
      missing_.assign(chunk.count, true);
    }
    if (chunk.index >= missing_.size() || !missing_[chunk.index]) {
      return false;
    }
    missing_[chunk.index] = false;
    for (std::size_t i = 0; i < chunk.size; ++i) {
      const bus::SubmapPose& submap = chunk.submaps[i];
      coming_.push_back({static_cast<std::int32_t>(submap.id), submap.version, submap.anchor_odom, isometry_of(submap.T_map_submap)});
    }
    if (std::find(missing_.begin(), missing_.end(), true) != missing_.end()) {
      return false;
    }
    places_ = coming_;
    std::sort(places_.begin(), places_.end(), [](const SubmapPlace& a, const SubmapPlace& b) { return a.id < b.id; });
    places_epoch_ = epoch_;
    return true;
  }

  const std::vector<SubmapPlace>& places() const { return places_; }
  std::uint32_t epoch() const { return places_epoch_; }

 private:
  Stamp stamp_{};
  std::uint32_t epoch_ = 0;
  std::vector<bool> missing_;
  std::vector<SubmapPlace> coming_;
  std::vector<SubmapPlace> places_;
  std::uint32_t places_epoch_ = 0;
};

}  // namespace slamd::client
