#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"

namespace slamd::occupancy {

/// Numbers the changes of blocks, 1, 2, 3, …, none twice, and keeps the blocks in the order of their last one. A block that
/// enters the window changes by that.
/// Real-time: allocates in the constructor only; settle() is O(blocks).
class ChangeOrder {
 public:
  explicit ChangeOrder(std::size_t slots) : numbers_(slots), order_(slots), changed_(slots) { clear(); }

  /// All blocks have changed now, once.
  void clear() {
    newest_ = settled_ = 0;
    numbers_.clear();
    numbers_.resize(numbers_.capacity());
    order_.clear();
    changed_.clear();
    for (std::uint32_t slot = 0; slot < numbers_.size(); ++slot) {
      touch(slot);
    }
    settle();
  }

  /// Notes a change; those of one block before settle() count once.
  void touch(std::uint32_t slot) {
    if (numbers_[slot] <= settled_) {
      numbers_[slot] = ++newest_;
      changed_.push_back(slot);
    }
  }

  /// Puts the blocks that have changed since the last call behind the others.
  void settle() {
    const auto moved = std::remove_if(order_.begin(), order_.end(), [this](std::uint32_t slot) { return numbers_[slot] > settled_; });
    order_.resize(static_cast<std::size_t>(moved - order_.begin()));
    for (const std::uint32_t slot : changed_) {
      order_.push_back(slot);
    }
    changed_.clear();
    settled_ = newest_;
  }

  std::uint64_t newest() const { return newest_; }
  std::uint64_t number(std::uint32_t slot) const { return numbers_[slot]; }

  /// Returns the slots of the blocks that have changed after a number, the longest ago first; after settle().
  std::span<const std::uint32_t> after(std::uint64_t number) const {
    const auto slots = order_.view();
    const auto first = std::upper_bound(slots.begin(), slots.end(), number,
                                        [this](std::uint64_t n, std::uint32_t slot) { return n < numbers_[slot]; });
    return {first, slots.end()};
  }

 private:
  std::uint64_t newest_ = 0;
  std::uint64_t settled_ = 0;
  BoundedVector<std::uint64_t> numbers_;  // per slot
  BoundedVector<std::uint32_t> order_;
  BoundedVector<std::uint32_t> changed_;  // since settle()
};

}  // namespace slamd::occupancy
