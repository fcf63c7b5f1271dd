#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "core/base/bounded_vector.hpp"
#include "core/map/cell_table.hpp"
#include "core/map/nearest.hpp"
#include "core/map/point_cell.hpp"

namespace slamd::map {

/// Points in cubic cells, one a sub-cube, for exact nearest neighbours within one cell's side.
///
/// A search begins in the query's cell and the seven that share the corner nearest to it; it looks further only while
/// less than k points are found within half a side. Cells know their neighbours, so that one look-up serves a search.
/// Frames: odom.  Units: m.
/// Real-time: allocates in the constructor only.
class PointGrid {
 public:
  PointGrid(float cell_m, std::size_t max_cells);

  /// Takes points in, each unless its sub-cube holds one, and marks their cells as touched at `path_m`.
  void insert(std::span<const Eigen::Vector3f> points_odom, float path_m);

  /// Drops the cells last touched before `path_m`.
  void forget_before(float path_m);

  /// Finds the nearest stored points, nearest first: exact within `radius_m` ≤ cell_m.
  Neighbours nearest(const Eigen::Vector3f& query_odom, float radius_m) const;

  /// So many queries or points ahead `prefetch` serves best.
  static constexpr std::ptrdiff_t kAhead = 6;

  /// Brings what `nearest` and `insert` will look at nearer to the processor.
  void prefetch(const Eigen::Vector3f& p_odom) const {
    const std::uint32_t place = cells_.place_of(geometry::key_of(p_odom, inverse_cell_));
    if (place != CellTable<PointCell>::kNone) {
      cells_.prefetch(place);
      __builtin_prefetch(&surroundings_[place]);
    }
  }

  /// The cells by their places.
  const CellTable<PointCell>& table() const { return cells_; }

  void clear();
  std::size_t cells() const { return cells_.size(); }
  std::uint64_t recycled() const { return cells_.recycled(); }

  /// Calls visit(p_odom) for every stored point.
  template <typename Visit>
  void for_each_point(Visit&& visit) const {
    cells_.for_each([&](CellKey, const PointCell& cell) {
      for (std::uint32_t i = 0; i < cell.count; ++i) {
        visit(cell.point(i));
      }
    });
  }

 private:
  /// The places of the 3 × 3 × 3 cells around one, itself in the middle; those that do not exist are kNone.
  struct alignas(64) Surroundings {
    std::array<std::uint32_t, 27> places;
  };

  void insert(const Eigen::Vector3f& p_odom, float path_m);
  void introduce(std::uint32_t place, const Eigen::Vector3f& p_odom);
  void withdraw(std::uint32_t place);

  float cell_m_;
  float inverse_cell_;
  CellSearch search_;
  CellTable<PointCell> cells_;
  BoundedVector<Surroundings> surroundings_;  // by place; of the cells that exist
};

}  // namespace slamd::map
