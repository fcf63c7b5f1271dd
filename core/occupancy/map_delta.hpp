#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "core/base/stamp.hpp"
#include "core/occupancy/number_ranges.hpp"
#include "core/occupancy/state_map.hpp"

namespace slamd::occupancy {

/// The side of no window is longer. Units: blocks.
inline constexpr std::int32_t kLongestSide = 1024;
/// And none has more blocks: 32 MB of states.
inline constexpr std::size_t kMostBlocks = 1 << 18;

/// A message about the map, which stands for itself: it holds every block whose last change, when it was made, was one of
/// `covers`. So whoever has heard messages that cover all numbers up to the newest has the whole map, in whatever order
/// they came, and whoever has not knows which numbers to ask for. docs/protocol.md, SLAMD_MAP_DELTA.
struct MapDelta {
  static constexpr std::size_t kPayload_bytes = 1296;

  Stamp stamp{};             // of the scan that changed the map last
  std::int64_t map_id = 0;   // grows with each map; a message of an older one is to be dropped
  std::uint32_t epoch = 0;   // of odom, as in SLAMD_SUBMAP_POSES
  NumberRange covers;
  std::uint64_t newest = 0;  // number of the newest change when this was made
  std::uint64_t digest = 0;  // of the map then: sum of BlockStates::digest()
  double cell_m = 0.2;
  Window window;             // then: what lies outside is gone
  std::int32_t submap = -1;  // that all blocks of this message belong to; -1: none
  BlockIndex anchor;         // T_odom_submap is the translation to this block's first corner
  std::uint16_t blocks = 0;  // that the payload holds
  FixedVector<std::byte, kPayload_bytes> payload;
};

/// A client's request for what it lacks.
struct MapRequest {
  static constexpr std::size_t kRanges = 16;

  std::int64_t map_id = 0;
  FixedVector<NumberRange, kRanges> ranges;
};

/// A block as a message tells it.
struct SentBlock {
  std::uint64_t number = 0;  // of its last change
  BlockIndex index;
  BlockStates states;
};

/// Writes blocks into a message's payload, in the order of their numbers.
/// Real-time: no allocation.
class BlockWriter {
 public:
  /// The message's covers.from and window are set; its blocks are forgotten.
  explicit BlockWriter(MapDelta& message);

  /// Returns whether there was room for the block.
  bool add(const SentBlock& block);

 private:
  MapDelta& message_;
  std::uint64_t number_;
  std::int32_t place_ = 0;
};

/// Reads the blocks of a message from whoever sent it.
/// Real-time: no allocation.
class BlockReader {
 public:
  explicit BlockReader(const MapDelta& message) : message_(message), number_(message.covers.from) {}

  /// Returns the next block.  Errors: nothing at the end, and where the payload is malformed.
  std::optional<SentBlock> next();

  /// How far the payload was read.
  std::size_t used_bytes() const { return at_; }

 private:
  std::optional<std::uint64_t> read_number();
  std::optional<BlockStates> read_states();

  const MapDelta& message_;
  std::size_t at_ = 0;
  std::uint64_t number_;
  std::int64_t place_ = 0;
};

/// Tells whether a message's fields are in their ranges and its payload holds exactly its blocks.
bool is_well_formed(const MapDelta& message);

}  // namespace slamd::occupancy
