#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

/// What is occupied around the robot. Space is cut into cubic cells, and these into blocks of 8 × 8 × 8 whose grid has odom's
/// origin for a corner.
namespace slamd::occupancy {

inline constexpr int kBlockSide = 8;
inline constexpr int kBlockCells = kBlockSide * kBlockSide * kBlockSide;

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// Which block of odom's grid.
struct BlockIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;

  friend bool operator==(const BlockIndex&, const BlockIndex&) = default;
};

/// Which cell of odom's grid: it holds the points with index · cell_m ≤ p_odom < (index + 1) · cell_m.
struct CellIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;

  friend bool operator==(const CellIndex&, const CellIndex&) = default;

  BlockIndex block() const { return {x >> 3, y >> 3, z >> 3}; }

  /// Number in its block: x grows first, then y, then z.
  int place() const { return (x & 7) + 8 * (y & 7) + 64 * (z & 7); }
};

/// Returns the cell that holds a point. Units: m. Coordinates beyond ± 2³⁰ cells are cut to that.
inline CellIndex cell_of(const Eigen::Vector3d& p_odom, double cell_m) {
  constexpr double kLimit = 1 << 30;
  const Eigen::Array3d i = (p_odom.array() / cell_m).floor().max(-kLimit).min(kLimit);
  return {static_cast<std::int32_t>(i.x()), static_cast<std::int32_t>(i.y()), static_cast<std::int32_t>(i.z())};
}

inline Eigen::Vector3d centre_of(const CellIndex& cell, double cell_m) {
  return cell_m * (Eigen::Vector3d(cell.x, cell.y, cell.z).array() + 0.5);
}

/// The states of a block's cells, a bit each in two planes: bit x + 8 y of word z. In neither: unknown; never in both.
struct BlockStates {
  std::array<std::uint64_t, kBlockSide> free{};
  std::array<std::uint64_t, kBlockSide> occupied{};

  friend bool operator==(const BlockStates&, const BlockStates&) = default;

  CellState at(int place) const {
    const std::uint64_t bit = std::uint64_t{1} << (place & 63);
    const auto word = static_cast<std::size_t>(place >> 6);
    return (occupied[word] & bit) != 0 ? CellState::kOccupied : (free[word] & bit) != 0 ? CellState::kFree : CellState::kUnknown;
  }

  void set(int place, CellState state) {
    const std::uint64_t bit = std::uint64_t{1} << (place & 63);
    const auto word = static_cast<std::size_t>(place >> 6);
    free[word] = state == CellState::kFree ? free[word] | bit : free[word] & ~bit;
    occupied[word] = state == CellState::kOccupied ? occupied[word] | bit : occupied[word] & ~bit;
  }

  bool all_unknown() const { return *this == BlockStates{}; }

  /// Returns a number that tells blocks apart, 0 for one that is all unknown. A map's digest is the sum of its blocks', so
  /// that it follows each change and needs no order.
  /// Source: FNV-1a of 64 bits, over index and planes as they would be sent, most significant byte first.
  std::uint64_t digest(const BlockIndex& index) const {
    if (all_unknown()) {
      return 0;
    }
    std::uint64_t hash = 0xCBF29CE484222325U;
    const auto take = [&hash](std::uint64_t value, int bytes) {
      for (int i = bytes - 1; i >= 0; --i) {
        hash = (hash ^ ((value >> (8 * i)) & 0xFFU)) * 0x100000001B3U;
      }
    };
    take(static_cast<std::uint32_t>(index.x), 4);
    take(static_cast<std::uint32_t>(index.y), 4);
    take(static_cast<std::uint32_t>(index.z), 4);
    for (const std::uint64_t word : free) {
      take(word, 8);
    }
    for (const std::uint64_t word : occupied) {
      take(word, 8);
    }
    return hash;
  }
};

}  // namespace slamd::occupancy
