#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace slamd::geometry {

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

/// Where a key is looked for first in a table whose size is a power of two: by the upper bits of a product, for only they
/// depend on all of the key's. Source: multiplicative hashing, Knuth, 6.4.
class CellHash {
 public:
  /// Of a table of two slots or more.
  explicit CellHash(std::size_t slots = 2) : shift_(64 - std::countr_zero(slots)) {}

  std::size_t operator()(CellKey key) const { return (key * 0x9E3779B97F4A7C15ULL) >> shift_; }

 private:
  int shift_;
};

}  // namespace slamd::geometry
