#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/occupancy/cells.hpp"
#include "core/occupancy/window.hpp"

namespace slamd::occupancy {

/// The states of all cells in a window that goes with the robot: the map that daemon and clients share.
/// Memory: 128 bytes a block, sized once.
class StateMap {
 public:
  /// Of no window: everything is unknown.
  StateMap() = default;

  StateMap(const Window& window, double cell_m) : cell_m_(cell_m), window_(window), blocks_(window.blocks()) {}

  double cell_m() const { return cell_m_; }
  const Window& window() const { return window_; }
  std::size_t size() const { return blocks_.size(); }

  const BlockStates& block(std::size_t slot) const { return blocks_[slot]; }
  BlockStates& block(std::size_t slot) { return blocks_[slot]; }

  /// What lies outside the window is unknown.
  CellState at(const CellIndex& cell) const {
    const BlockIndex block = cell.block();
    return window_.contains(block) ? blocks_[window_.slot_of(block)].at(cell.place()) : CellState::kUnknown;
  }

  /// Moves the window: calls entered(slot, block that was there) for each slot that changes hands, which then is unknown.
  template <typename Entered>
  void move_to(const BlockIndex& first, Entered&& entered) {
    if (first == window_.first) {
      return;
    }
    const Window before = window_;
    window_.first = first;
    for (std::size_t slot = 0; slot < blocks_.size(); ++slot) {
      const BlockIndex old = before.block_at(slot);
      if (!window_.contains(old)) {
        entered(slot, old);
        blocks_[slot] = {};
      }
    }
  }

  /// Makes everything unknown; the window stays.
  void clear() { blocks_.assign(blocks_.size(), {}); }

 private:
  double cell_m_ = 0.2;
  Window window_{{}, {0, 0, 0}};
  std::vector<BlockStates> blocks_;
};

}  // namespace slamd::occupancy
