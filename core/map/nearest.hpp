#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/map/point_cell.hpp"

namespace slamd::map {

/// The k nearest stored points of a query, nearest first.
struct Neighbours {
  static constexpr std::size_t kMax = 5;

  std::size_t count = 0;
  std::array<float, kMax> distance_sq_m2{};
  std::array<Eigen::Vector3f, kMax> points_odom{};

  /// Returns the squared distance that a further point must beat. Units: m².
  float limit_sq(float radius_sq) const { return count == kMax ? distance_sq_m2[kMax - 1] : radius_sq; }

  void insert(float distance_sq, const Eigen::Vector3f& p) {
    std::size_t i = count < kMax ? count++ : kMax - 1;
    for (; i > 0 && distance_sq_m2[i - 1] > distance_sq; --i) {
      distance_sq_m2[i] = distance_sq_m2[i - 1];
      points_odom[i] = points_odom[i - 1];
    }
    distance_sq_m2[i] = distance_sq;
    points_odom[i] = p;
  }
};

/// Offers all points of a cell that are nearer than the current limit. The vector form and its scalar twin give the
/// same bits: both round after each operation, and offer in the same order.
using CellSearch = void (*)(const PointCell& cell, const Eigen::Vector3f& query, float radius_sq, Neighbours& best);

void search_cell_scalar(const PointCell& cell, const Eigen::Vector3f& query, float radius_sq, Neighbours& best);

/// Returns the fastest search that this processor can run: AVX2, NEON, or the scalar twin.
CellSearch fastest_cell_search();

}  // namespace slamd::map
