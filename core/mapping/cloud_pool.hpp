#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "core/base/bounded_vector.hpp"

namespace slamd::mapping {

/// Names a cloud in its pool.
using CloudSlot = std::uint32_t;
inline constexpr CloudSlot kNoCloud = std::numeric_limits<CloudSlot>::max();

/// The keyframes' clouds in one fixed block: a slot each, three 16-bit numbers a point.
/// Units: kStep_m to each number, so that points reach ±163 m and err by 1.5 mm (1σ) an axis; farther ones are left out.
/// Memory: reserved once, and touched only as slots are first used.
class CloudPool {
 public:
  static constexpr float kStep_m = 0.005F;
  static constexpr float kReach_m = kStep_m * std::numeric_limits<std::int16_t>::max();

  CloudPool(std::size_t slots, std::size_t points_a_slot);

  /// Copies a cloud into a free slot; kNoCloud when none is free. Of more points than fit, the first ones.
  CloudSlot store(std::span<const Eigen::Vector3f> points);

  void release(CloudSlot slot);

  std::size_t points(CloudSlot slot) const { return counts_[slot]; }

  /// Calls visit(p) for each point of a cloud.
  template <typename Visit>
  void for_each_point(CloudSlot slot, Visit&& visit) const {
    const std::int16_t* numbers = block_.get() + std::size_t{slot} * 3 * points_a_slot_;
    for (std::size_t i = 0; i < counts_[slot]; ++i, numbers += 3) {
      visit(Eigen::Vector3f(kStep_m * static_cast<float>(numbers[0]), kStep_m * static_cast<float>(numbers[1]),
                            kStep_m * static_cast<float>(numbers[2])));
    }
  }

  std::size_t free_slots() const { return free_.size(); }
  std::size_t points_a_slot() const { return points_a_slot_; }

 private:
  std::size_t points_a_slot_;
  std::unique_ptr<std::int16_t[]> block_;
  BoundedVector<std::uint32_t> counts_;  // of points, by slot
  BoundedVector<CloudSlot> free_;
};

}  // namespace slamd::mapping
