#include "client/map_view.hpp"

#include <algorithm>

namespace slamd::client {

using occupancy::BlockIndex;
using occupancy::cell_of;

bool MapView::is_current(const Eigen::Vector3d& p_odom) const {
  const BlockIndex block = cell_of(p_odom, map_.cell_m()).block();
  return known() && map_.window().contains(block) && (complete_ || numbers_[map_.window().slot_of(block)] >= current_from_);
}

const SubmapPlace* MapView::submap(std::int32_t id) const {
  const auto found = std::lower_bound(submaps_.begin(), submaps_.end(), id, [](const SubmapPlace& place, std::int32_t wanted) { return place.id < wanted; });
  return found != submaps_.end() && found->id == id ? &*found : nullptr;
}

Eigen::Vector3d MapView::to_map(const Eigen::Vector3d& p_odom) const {
  const BlockIndex block = cell_of(p_odom, map_.cell_m()).block();
  const SubmapPlace* place = known() && map_.window().contains(block) ? submap(block_submaps_[map_.window().slot_of(block)]) : nullptr;
  return place != nullptr ? place->to_map(p_odom) : Eigen::Vector3d(T_map_odom_ * p_odom);
}

}  // namespace slamd::client
