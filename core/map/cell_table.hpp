#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/assert.hpp"
#include "core/base/bounded_vector.hpp"
#include "core/geometry/cell_key.hpp"

namespace slamd::map {

using geometry::CellKey;

/// Cells in a fixed block of memory, found by key (open addressing, linear probing), recycled oldest first.
///
/// A cell's age is the path length at which it was last touched; `forget_before` drops what is older than a
/// window, and a full table recycles its least recently touched cell. A cell keeps its place while it lives.
/// Cell: has clear().
/// Real-time: allocates in the constructor only; find, touch and insert are O(1) amortised.
template <typename Cell>
class CellTable {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit CellTable(std::size_t capacity)
      : cells_(capacity), links_(capacity), slots_(std::bit_ceil(2 * capacity + 2)) {
    cells_.resize(capacity);
    links_.resize(capacity);
    slots_.resize(slots_.capacity());
    mask_ = slots_.size() - 1;
    home_ = geometry::CellHash(slots_.size());
    clear();
  }

  /// Returns the place of the cell with this key, or kNone.
  std::uint32_t place_of(CellKey key) const {
    for (std::size_t i = home_(key);; i = (i + 1) & mask_) {
      const Slot& slot = slots_[i];
      if (slot.cell == kNone || slot.key == key) {
        return slot.cell;
      }
    }
  }

  /// Returns the cell with this key, or nullptr.
  const Cell* find(CellKey key) const {
    const std::uint32_t place = place_of(key);
    return place == kNone ? nullptr : &cells_[place];
  }

  Cell& operator[](std::uint32_t place) { return cells_[place]; }
  const Cell& operator[](std::uint32_t place) const { return cells_[place]; }

  struct Touched {
    std::uint32_t place;
    bool created;
  };

  /// Finds the cell with this key, makes a fresh one if there was none, and marks it as touched at `path_m`, which
  /// does not decrease. Calls released(place) for a cell that had to give way.
  template <typename Released>
  Touched touch(CellKey key, float path_m, Released&& released) {
    const std::uint32_t place = place_of(key);
    if (place == kNone) {
      return {create(key, path_m, released), true};
    }
    if (links_[place].path_m != path_m && newest_ != place) {
      unlink(place);
      link_newest(place);
    }
    links_[place].path_m = path_m;
    return {place, false};
  }

  Cell& touch(CellKey key, float path_m) { return cells_[touch(key, path_m, [](std::uint32_t) {}).place]; }

  /// Brings what place_of will look at nearer to the processor.
  void prefetch_slot(CellKey key) const { __builtin_prefetch(&slots_[home_(key)]); }

  /// Brings the head of a cell, and its age, nearer to the processor.
  void prefetch(std::uint32_t place) const {
    constexpr std::size_t kLine_bytes = 64;
    const auto* bytes = reinterpret_cast<const std::byte*>(&cells_[place]);
    __builtin_prefetch(bytes);
    if constexpr (sizeof(Cell) > kLine_bytes) {
      __builtin_prefetch(bytes + kLine_bytes);
    }
    __builtin_prefetch(&links_[place]);
  }

  /// Drops all cells last touched before `path_m`; calls released(place) for each.
  template <typename Released>
  void forget_before(float path_m, Released&& released) {
    while (oldest_ != kNone && links_[oldest_].path_m < path_m) {
      released(oldest_);
      release(oldest_);
    }
  }

  void forget_before(float path_m) {
    forget_before(path_m, [](std::uint32_t) {});
  }

  void clear() {
    for (Slot& slot : slots_) {
      slot = Slot{};
    }
    for (std::uint32_t i = 0; i < links_.size(); ++i) {
      links_[i].newer = i + 1 < links_.size() ? i + 1 : kNone;
    }
    free_ = links_.empty() ? kNone : 0;
    oldest_ = newest_ = kNone;
    size_ = 0;
  }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return cells_.size(); }
  std::uint64_t recycled() const { return recycled_; }

  /// Returns the cell at a place below capacity(), or nullptr: for copies that are made in parts while the table is in use.
  const Cell* at(std::uint32_t place) const {
    return place_of(links_[place].key) == place ? &cells_[place] : nullptr;
  }

  /// Calls visit(key, cell) for every cell, oldest first.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::uint32_t cell = oldest_; cell != kNone; cell = links_[cell].newer) {
      visit(links_[cell].key, cells_[cell]);
    }
  }

 private:
  struct Link {
    CellKey key = 0;
    float path_m = 0.0F;
    std::uint32_t older = kNone;
    std::uint32_t newer = kNone;  // of a free cell: the next free one
  };

  struct Slot {
    CellKey key = 0;
    std::uint32_t cell = kNone;
  };

  template <typename Released>
  std::uint32_t create(CellKey key, float path_m, Released&& released) {
    SLAMD_ASSERT(!cells_.empty());
    if (free_ == kNone) {
      ++recycled_;
      released(oldest_);
      release(oldest_);
    }
    const std::uint32_t place = free_;
    free_ = links_[place].newer;
    cells_[place].clear();
    links_[place].key = key;
    links_[place].path_m = path_m;
    link_newest(place);
    std::size_t i = home_(key);
    while (slots_[i].cell != kNone) {
      i = (i + 1) & mask_;
    }
    slots_[i] = {key, place};
    ++size_;
    return place;
  }

  void release(std::uint32_t place) {
    unlink(place);
    std::size_t hole = home_(links_[place].key);
    while (slots_[hole].cell != place) {
      hole = (hole + 1) & mask_;
    }
    // Close the gap: move back each follower whose home lies at or before the hole (Knuth, 6.4 R).
    for (std::size_t i = (hole + 1) & mask_; slots_[i].cell != kNone; i = (i + 1) & mask_) {
      const std::size_t wanted = home_(slots_[i].key);
      if (((i - wanted) & mask_) >= ((i - hole) & mask_)) {
        slots_[hole] = slots_[i];
        hole = i;
      }
    }
    slots_[hole].cell = kNone;
    links_[place].newer = free_;
    free_ = place;
    --size_;
  }

  void unlink(std::uint32_t cell) {
    const Link& link = links_[cell];
    (link.older == kNone ? oldest_ : links_[link.older].newer) = link.newer;
    (link.newer == kNone ? newest_ : links_[link.newer].older) = link.older;
  }

  void link_newest(std::uint32_t cell) {
    links_[cell].older = newest_;
    links_[cell].newer = kNone;
    (newest_ == kNone ? oldest_ : links_[newest_].newer) = cell;
    newest_ = cell;
  }

  BoundedVector<Cell> cells_;
  BoundedVector<Link> links_;
  BoundedVector<Slot> slots_;
  std::size_t mask_ = 0;
  geometry::CellHash home_;
  std::uint32_t free_ = kNone;
  std::uint32_t oldest_ = kNone;
  std::uint32_t newest_ = kNone;
  std::size_t size_ = 0;
  std::uint64_t recycled_ = 0;
};

}  // namespace slamd::map
