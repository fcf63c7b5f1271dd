#include "core/mapping/cloud_pool.hpp"

#include <cmath>

#include "core/base/assert.hpp"

namespace slamd::mapping {

CloudPool::CloudPool(std::size_t slots, std::size_t points_a_slot)
    : points_a_slot_(points_a_slot),
      block_(std::make_unique_for_overwrite<std::int16_t[]>(slots * 3 * points_a_slot)),
      counts_(slots),
      free_(slots) {
  counts_.resize(slots);
  for (std::size_t i = slots; i-- > 0;) {
    free_.push_back(static_cast<CloudSlot>(i));
  }
}

CloudSlot CloudPool::store(std::span<const Eigen::Vector3f> points) {
  if (free_.empty()) {
    return kNoCloud;
  }
  const CloudSlot slot = free_.back();
  free_.resize(free_.size() - 1);
  std::int16_t* numbers = block_.get() + std::size_t{slot} * 3 * points_a_slot_;
  std::uint32_t count = 0;
  for (const Eigen::Vector3f& p : points) {
    if (count == points_a_slot_) {
      break;
    }
    if (!(p.cwiseAbs().maxCoeff() <= kReach_m)) {
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      *numbers++ = static_cast<std::int16_t>(std::lround(p[axis] / kStep_m));
    }
    ++count;
  }
  counts_[slot] = count;
  return slot;
}

void CloudPool::release(CloudSlot slot) {
  SLAMD_ASSERT(slot < counts_.size() && !free_.full());
  counts_[slot] = 0;
  free_.push_back(slot);
}

}  // namespace slamd::mapping
