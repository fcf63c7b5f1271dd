#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "core/map/point_cell.hpp"

namespace slamd::map {

/// The k nearest stored points of a query, nearest first.
struct Neighbours {
  static constexpr std::size_t kMax = 5;

  std::size_t count = 0;
  std::array<float, kMax> distance_sq_m2{};
  std::array<Eigen::Vector3f, kMax> points_odom{};
  float others_beyond_sq_m2 = 0.0F;  // no other stored point is nearer than this; at most the radius of the search
};

/// A cell that a search looks into, unless all of it lies too far away.
struct CellVisit {
  const PointCell* cell;
  float gap_sq_m2;  // from the query to the cell's nearest face
};

/// The best points of a search so far, nearest first, one more than are given out. A point is a number: its squared distance,
/// whose bits sort as the distance does, above its place among the visited cells. Equal distances so have an order, too.
struct Nearest {
  explicit Nearest(float radius_sq_m2) { keys.fill(key_of(radius_sq_m2, 0)); }

  static std::uint64_t key_of(float distance_sq_m2, std::uint32_t place) {
    return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(distance_sq_m2)) << 32 | place;
  }
  static float distance_sq_m2(std::uint64_t key) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
  }
  static std::uint32_t place(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

  /// Returns the squared distance that a further point must beat. Units: m².
  float limit_sq_m2() const { return distance_sq_m2(keys.back()); }

  void offer(std::uint64_t key) {
    for (std::uint64_t& held : keys) {
      const std::uint64_t nearer = std::min(held, key);
      key = std::max(held, key);
      held = nearer;
    }
  }

  std::array<std::uint64_t, Neighbours::kMax + 1> keys;
};

/// Offers the points of the cells from the one with index `first` on, skipping cells beyond the current limit. A
/// point's place is its cell's index times PointCell::kMaxPoints plus its own. The vector forms and their scalar twin
/// give the same bits: each operation rounds, and they offer in the same order.
using CellSearch = void (*)(std::span<const CellVisit> visits, std::size_t first, const Eigen::Vector3f& query,
                            Nearest& best);

void search_cells_scalar(std::span<const CellVisit> visits, std::size_t first, const Eigen::Vector3f& query,
                         Nearest& best);

/// Returns the fastest search that this processor can run: AVX2, NEON, or the scalar twin.
CellSearch fastest_cell_search();

}  // namespace slamd::map
