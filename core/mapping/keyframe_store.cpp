#include "core/mapping/keyframe_store.hpp"

#include <algorithm>

#include "core/base/assert.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::mapping {

namespace {

constexpr double kNear_m = 10.0;
constexpr double kSameView = 0.707;  // cos 45°

}  // namespace

Eigen::Matrix3d level_of(const Eigen::Vector3d& up_base) {
  // The shortest turn that takes z to up leaves the heading as it is, to second order in the tilt.
  return geometry::rotation_between(Eigen::Vector3d::UnitZ(), up_base);
}

KeyframeStore::KeyframeStore(std::size_t capacity, std::size_t points_a_cloud)
    : keyframes_(capacity), clouds_(capacity, points_a_cloud), placed_(capacity) {}

bool KeyframeStore::add(Keyframe keyframe, std::span<const Eigen::Vector3f> points_level) {
  SLAMD_ASSERT(empty() || back().id < keyframe.id);
  if (full()) {
    return false;
  }
  keyframe.cloud = clouds_.store(points_level);
  keyframes_.push_back(keyframe);
  return true;
}

std::size_t KeyframeStore::index_of(graph::KeyframeId id) const {
  const auto found = std::lower_bound(keyframes_.begin(), keyframes_.end(), id, [](const Keyframe& keyframe, graph::KeyframeId wanted) { return keyframe.id < wanted; });
  return found != keyframes_.end() && found->id == id ? static_cast<std::size_t>(found - keyframes_.begin()) : size();
}

void KeyframeStore::erase(std::size_t i) {
  SLAMD_ASSERT(i < size());
  clouds_.release(keyframes_[i].cloud);
  for (std::size_t k = i + 1; k < size(); ++k) {
    keyframes_[k - 1] = keyframes_[k];
  }
  keyframes_.resize(size() - 1);
}

void KeyframeStore::clear() {
  for (const Keyframe& keyframe : keyframes_) {
    clouds_.release(keyframe.cloud);
  }
  keyframes_.clear();
}

void KeyframeStore::append_cloud(std::size_t i, const geometry::Se3& T_out_level, BoundedVector<Eigen::Vector3f>& out) const {
  const Eigen::Matrix3f R = T_out_level.rotation().cast<float>();
  const Eigen::Vector3f t = T_out_level.translation().cast<float>();
  clouds_.for_each_point(keyframes_[i].cloud, [&](const Eigen::Vector3f& p) { out.try_push_back(R * p + t); });
}

std::optional<std::size_t> KeyframeStore::most_redundant_placed(std::size_t kept) {
  if (size() < kept + 2) {
    return std::nullopt;
  }
  const std::size_t end = size() - kept;  // of those that may go
  std::sort(placed_.begin(), placed_.end(), [](const Placed& a, const Placed& b) {
    return a.p_map.x() < b.p_map.x() || (a.p_map.x() == b.p_map.x() && a.index < b.index);
  });
  double least_m = kNear_m;
  std::optional<std::size_t> found;
  for (std::size_t a = 0; a < placed_.size(); ++a) {
    for (std::size_t b = a + 1; b < placed_.size() && placed_[b].p_map.x() - placed_[a].p_map.x() < least_m; ++b) {
      std::size_t older = std::min(placed_[a].index, placed_[b].index);
      const std::size_t newer = std::max(placed_[a].index, placed_[b].index);
      older = older == 0 ? newer : older;
      const double apart_m = (placed_[a].p_map - placed_[b].p_map).norm();
      if (older < end && apart_m < least_m && placed_[a].ahead_map.dot(placed_[b].ahead_map) > kSameView) {
        least_m = apart_m;
        found = older;
      }
    }
  }
  return found ? found : std::optional<std::size_t>(1);
}

}  // namespace slamd::mapping
