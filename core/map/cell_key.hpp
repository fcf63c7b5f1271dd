#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace slamd::map {

/// The integer coordinates of a cubic cell, packed into one word: 21 bits an axis, ± one million cells.
using CellKey = std::uint64_t;

inline constexpr std::int32_t kCellOffset = 1 << 20;

/// Returns the index of the cell that holds a coordinate: ⌊x⌋ without a call into libm, which it is without SSE 4.1.
/// Units: m; inverse_side in 1/m.
inline std::int32_t cell_index(float coordinate_m, float inverse_side) {
  const float scaled = coordinate_m * inverse_side;
  const auto whole = static_cast<std::int32_t>(scaled);
  return whole - (scaled < static_cast<float>(whole) ? 1 : 0);
}

inline CellKey pack(std::int32_t x, std::int32_t y, std::int32_t z) {
  constexpr CellKey kMask = (1U << 21) - 1;
  return ((static_cast<CellKey>(x + kCellOffset) & kMask) << 42) |
         ((static_cast<CellKey>(y + kCellOffset) & kMask) << 21) |
         (static_cast<CellKey>(z + kCellOffset) & kMask);
}

inline CellKey key_of(const Eigen::Vector3f& p, float inverse_side) {
  return pack(cell_index(p.x(), inverse_side), cell_index(p.y(), inverse_side), cell_index(p.z(), inverse_side));
}

}  // namespace slamd::map
