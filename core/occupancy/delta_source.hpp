#pragma once

#include <cstdint>
#include <span>

#include "core/occupancy/map_delta.hpp"
#include "core/occupancy/number_ranges.hpp"
#include "core/occupancy/rolling_grid.hpp"

namespace slamd::occupancy {

/// How much is sent beside what has changed. Units: messages an update.
struct DeltaConfig {
  int key_messages = 2;      // of what has not changed, round and round, so that who only listens misses nothing for long
  int repair_messages = 24;  // of what clients have asked for, however many they are
};

/// The messages of a map.
enum class DeltaKind { kChange, kKey, kRepair };

/// Makes messages of a grid: after each update what has changed, then key blocks, then what was asked for.
/// Real-time: no allocation; one thread, the grid's.
class DeltaSource {
 public:
  DeltaSource(const DeltaConfig& config, const RollingGrid& grid) : config_(config), grid_(grid) {}

  /// Begins another map, after RollingGrid::restart(). map_id grows.
  void restart(std::int64_t map_id, std::uint32_t epoch);

  /// Begins the messages of an update, with or without a scan since the last; at least one follows.
  void begin(Stamp stamp);

  /// Makes the next message. Returns whether there was one.
  bool next(MapDelta& message, DeltaKind& kind);

  /// Takes a request in; what several clients lack is sent once.
  void request(const MapRequest& request);

  /// Where a submap is anchored, for the messages of its blocks; the grid's set_submap() makes it that of what changes now.
  /// The last 256 are remembered: of older ones the blocks say no submap.
  void set_anchor(std::int32_t submap, const BlockIndex& anchor);

  /// What was asked for and is not sent yet.
  bool has_repairs() const { return !wanted_.empty(); }

 private:
  static constexpr std::size_t kAnchors = 256;
  struct Anchor {
    std::int32_t submap = -1;
    BlockIndex anchor;
  };

  void fill(MapDelta& message, std::uint64_t from, std::uint64_t to);
  const Anchor* anchor_of(std::int32_t submap) const;

  DeltaConfig config_;
  const RollingGrid& grid_;
  MapDelta head_;                  // what all messages of an update have in common
  std::uint64_t told_ = 0;         // the changes up to here have been sent
  std::uint64_t key_ = 0;          // the key blocks up to here, in this round
  bool change_left_ = false;
  int keys_left_ = 0;
  int repairs_left_ = 0;
  NumberRanges wanted_;
  std::array<Anchor, kAnchors> anchors_{};
};

}  // namespace slamd::occupancy
