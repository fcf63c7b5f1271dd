#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/assert.hpp"
#include "core/base/bounded_vector.hpp"
#include "core/map/cell_key.hpp"

namespace slamd::map {

/// Cells in a fixed block of memory, found by key (open addressing, linear probing), recycled oldest first.
///
/// A cell's age is the path length at which it was last touched; `forget_before` drops what is older than a
/// window, and a full table recycles its least recently touched cell.
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
    clear();
  }

  /// Returns the cell with this key, or nullptr.
  const Cell* find(CellKey key) const {
    for (std::size_t i = home(key);; i = (i + 1) & mask_) {
      const std::uint32_t cell = slots_[i];
      if (cell == kNone) {
        return nullptr;
      }
      if (links_[cell].key == key) {
        return &cells_[cell];
      }
    }
  }

  Cell* find(CellKey key) { return const_cast<Cell*>(static_cast<const CellTable*>(this)->find(key)); }

  /// Returns the cell with this key, a fresh one if there was none, and marks it as touched at `path_m`.
  Cell& touch(CellKey key, float path_m) {
    for (std::size_t i = home(key);; i = (i + 1) & mask_) {
      const std::uint32_t cell = slots_[i];
      if (cell == kNone) {
        return create(key, path_m);
      }
      if (links_[cell].key == key) {
        if (newest_ != cell) {
          unlink(cell);
          link_newest(cell);
        }
        links_[cell].path_m = path_m;
        return cells_[cell];
      }
    }
  }

  /// Drops all cells last touched before `path_m`.
  void forget_before(float path_m) {
    while (oldest_ != kNone && links_[oldest_].path_m < path_m) {
      release(oldest_);
    }
  }

  void clear() {
    for (auto& slot : slots_) {
      slot = kNone;
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

  /// How many places a cell can be at; for copies that go on while the table is in use.
  std::size_t slots() const { return slots_.size(); }

  /// Returns the cell at a place, or nullptr. A cell keeps its place but for those that move up when others are dropped.
  const Cell* at_slot(std::size_t slot) const { return slots_[slot] == kNone ? nullptr : &cells_[slots_[slot]]; }

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

  std::size_t home(CellKey key) const { return ((key * 0x9E3779B97F4A7C15ULL) >> 24) & mask_; }

  Cell& create(CellKey key, float path_m) {
    SLAMD_ASSERT(!cells_.empty());
    if (free_ == kNone) {
      ++recycled_;
      release(oldest_);
    }
    const std::uint32_t cell = free_;
    free_ = links_[cell].newer;
    cells_[cell] = Cell{};
    links_[cell].key = key;
    links_[cell].path_m = path_m;
    link_newest(cell);
    std::size_t i = home(key);
    while (slots_[i] != kNone) {
      i = (i + 1) & mask_;
    }
    slots_[i] = cell;
    ++size_;
    return cells_[cell];
  }

  void release(std::uint32_t cell) {
    unlink(cell);
    std::size_t hole = home(links_[cell].key);
    while (slots_[hole] != cell) {
      hole = (hole + 1) & mask_;
    }
    // Close the gap: move back each follower whose home lies at or before the hole (Knuth, 6.4 R).
    for (std::size_t i = (hole + 1) & mask_; slots_[i] != kNone; i = (i + 1) & mask_) {
      const std::size_t wanted = home(links_[slots_[i]].key);
      if (((i - wanted) & mask_) >= ((i - hole) & mask_)) {
        slots_[hole] = slots_[i];
        hole = i;
      }
    }
    slots_[hole] = kNone;
    links_[cell].newer = free_;
    free_ = cell;
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
  BoundedVector<std::uint32_t> slots_;
  std::size_t mask_ = 0;
  std::uint32_t free_ = kNone;
  std::uint32_t oldest_ = kNone;
  std::uint32_t newest_ = kNone;
  std::size_t size_ = 0;
  std::uint64_t recycled_ = 0;
};

}  // namespace slamd::map
