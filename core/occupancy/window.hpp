#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/occupancy/cells.hpp"

namespace slamd::occupancy {

/// The box of blocks that a rolling map holds. Each block has a slot, the same one wherever the window goes, that it shares
/// with those which lie a window's side away: so nothing moves in memory when the window does.
struct Window {
  BlockIndex first;                          // the lowest corner
  std::array<std::int32_t, 3> size{1, 1, 1};  // in blocks

  friend bool operator==(const Window&, const Window&) = default;

  std::size_t blocks() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  }

  bool contains(const BlockIndex& block) const {
    return inside(block.x, first.x, size[0]) && inside(block.y, first.y, size[1]) && inside(block.z, first.z, size[2]);
  }

  std::size_t slot_of(const BlockIndex& block) const {
    return static_cast<std::size_t>(remainder(block.x, size[0]) + size[0] * (remainder(block.y, size[1]) + size[1] * remainder(block.z, size[2])));
  }

  /// Returns the block of the window that has this slot.
  BlockIndex block_at(std::size_t slot) const {
    const auto i = static_cast<std::int64_t>(slot);
    const std::int64_t x = i % size[0];
    const std::int64_t y = i / size[0] % size[1];
    const std::int64_t z = i / size[0] / size[1];
    return {nearest_above(first.x, x, size[0]), nearest_above(first.y, y, size[1]), nearest_above(first.z, z, size[2])};
  }

  /// Numbers the window's blocks from its first corner on, x first, then y, then z; for messages.
  std::int32_t place_of(const BlockIndex& block) const {
    return block.x - first.x + size[0] * (block.y - first.y + size[1] * (block.z - first.z));
  }

  BlockIndex block_of_place(std::int32_t place) const {
    return {first.x + place % size[0], first.y + place / size[0] % size[1], first.z + place / size[0] / size[1]};
  }

 private:
  static bool inside(std::int32_t i, std::int32_t from, std::int32_t count) {
    return i >= from && std::int64_t{i} - from < count;
  }

  static std::int32_t remainder(std::int32_t i, std::int32_t n) {
    const std::int32_t r = i % n;
    return r < 0 ? r + n : r;
  }

  static std::int32_t nearest_above(std::int32_t from, std::int64_t wanted, std::int32_t n) {
    return static_cast<std::int32_t>(from + remainder(static_cast<std::int32_t>(wanted - remainder(from, n)), n));
  }
};

}  // namespace slamd::occupancy
