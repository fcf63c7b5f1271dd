#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/occupancy/map_delta.hpp"
#include "core/occupancy/number_ranges.hpp"
#include "core/occupancy/state_map.hpp"

namespace slamd::occupancy {

/// A client's copy of the daemon's map, made of messages that may come late, twice, in any order or never. It always knows
/// what it lacks.
/// Threads: one. Memory: allocates when it hears of a window of another size, and for blocks that nobody takes by take_left().
class Mirror {
 public:
  enum class Verdict {
    kTaken,
    kNewMap,     // taken, and everything before it was forgotten
    kOlderMap,   // dropped
    kMalformed,  // dropped
    kDiffers,    // taken; the digest says that the copy is wrong, so that all of it is asked for anew
  };

  Verdict apply(const MapDelta& message);

  /// A block that the window has left behind.
  struct LeftBlock {
    std::int64_t map_id = 0;
    std::int32_t submap = -1;
    BlockIndex index;
    BlockStates states;
  };

  /// Calls visit(LeftBlock) for each that has been left since the last call and was not all unknown, and forgets it.
  template <typename Visit>
  void take_left(Visit&& visit) {
    for (const LeftBlock& block : left_) {
      visit(block);
    }
    left_.clear();
  }

  /// Forgets the map, and its number: the next message begins another, even one with a lower map_id.
  void forget();

  /// Whether there is a map.
  bool known() const { return map_id_ != 0; }

  /// Whether the map is the daemon's as of newest().
  bool complete() const { return known() && missing_.empty(); }

  /// The changes it has not heard of.
  std::span<const NumberRange> missing() const { return missing_.view(); }

  /// Returns what to ask for.
  MapRequest request() const;

  /// Whether a block of the window is as the daemon had it at newest().
  bool is_current(std::size_t slot) const { return missing_.empty() || missing_.view().back().to <= numbers_[slot]; }

  const StateMap& map() const { return map_; }
  std::uint64_t newest() const { return newest_; }
  std::int64_t map_id() const { return map_id_; }
  std::uint32_t epoch() const { return epoch_; }
  Stamp stamp() const { return stamp_; }

  /// Number of the last change of a block that has come, 0 for none; no two blocks share one.
  std::uint64_t number(std::size_t slot) const { return numbers_[slot]; }

  /// The submap that a block belongs to, or -1.
  std::int32_t submap(std::size_t slot) const { return submaps_[slot]; }

  /// Sum of BlockStates::digest().
  std::uint64_t digest() const { return digest_; }

 private:
  void begin(const MapDelta& message);
  void lose_all();
  void follow(const Window& window);
  void put(const SentBlock& block, std::int32_t submap);

  std::int64_t map_id_ = 0;
  std::uint32_t epoch_ = 0;
  Stamp stamp_{};
  std::uint64_t newest_ = 0;
  std::uint64_t digest_ = 0;
  NumberRanges missing_;
  StateMap map_;
  std::vector<std::uint64_t> numbers_;  // per slot
  std::vector<std::int32_t> submaps_;   // per slot
  std::vector<LeftBlock> left_;
};

}  // namespace slamd::occupancy
