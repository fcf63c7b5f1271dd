#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/fixed_vector.hpp"

namespace slamd::occupancy {

/// The change numbers above `from`, up to and with `to`.
struct NumberRange {
  std::uint64_t from = 0;
  std::uint64_t to = 0;

  friend bool operator==(const NumberRange&, const NumberRange&) = default;
};

/// A set of change numbers, as ranges that do not touch, in order. What there is no room for makes it larger, never smaller:
/// who asks for it asks for too much then, and misses nothing.
/// Real-time: no allocation; O(ranges).
class NumberRanges {
 public:
  static constexpr std::size_t kCapacity = 64;

  std::span<const NumberRange> view() const { return ranges_.view(); }
  bool empty() const { return ranges_.empty(); }
  void clear() { ranges_.clear(); }

  void add(const NumberRange& range) {
    if (range.from >= range.to) {
      return;
    }
    NumberRange sum = range;
    Ranges kept;
    for (const NumberRange& other : ranges_) {
      if (other.to < sum.from || other.from > sum.to) {
        kept.push_back(other);
      } else {
        sum = {std::min(sum.from, other.from), std::max(sum.to, other.to)};
      }
    }
    if (kept.full()) {  // joined with a neighbour, and all between
      const auto above = std::find_if(kept.begin(), kept.end(), [&](const NumberRange& other) { return other.from > sum.to; });
      NumberRange& neighbour = above == kept.end() ? kept.back() : *above;
      neighbour = {std::min(neighbour.from, sum.from), std::max(neighbour.to, sum.to)};
      ranges_ = kept;
      return;
    }
    const auto above = std::find_if(kept.begin(), kept.end(), [&](const NumberRange& other) { return other.from > sum.to; });
    const auto at = above - kept.begin();
    kept.push_back(sum);
    std::rotate(kept.begin() + at, kept.end() - 1, kept.end());
    ranges_ = kept;
  }

  void remove(const NumberRange& range) {
    if (range.from >= range.to) {
      return;
    }
    Ranges kept;
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      const NumberRange& other = ranges_[i];
      const NumberRange below{other.from, std::min(other.to, range.from)};
      const NumberRange above{std::max(other.from, range.to), other.to};
      const bool splits = below.from < below.to && above.from < above.to;
      if (splits && kept.size() + (ranges_.size() - i) >= kCapacity) {
        kept.push_back(other);  // no room for two
        continue;
      }
      for (const NumberRange& part : {below, above}) {
        if (part.from < part.to) {
          kept.push_back(part);
        }
      }
    }
    ranges_ = kept;
  }

 private:
  using Ranges = FixedVector<NumberRange, kCapacity>;

  Ranges ranges_;
};

}  // namespace slamd::occupancy
