#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/base/fixed_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/occupancy/change_order.hpp"
#include "core/occupancy/state_map.hpp"

namespace slamd::occupancy {

/// An axis-aligned box of the robot's own body, in base.  Units: m.
struct BodyBox {
  float min_m[3];
  float max_m[3];
};

/// What a scan does to a cell's evidence, an integer that stands for log-odds: 8 are about ln(0.6 / 0.4).
/// A hit makes any cell occupied at once; one that is occupied becomes free when misses outweigh what was for it, after 4
/// scans at least and 14 at most; a free one that is neither hit nor missed stays so. No state is left by the same step that
/// led to it, so that blocks do not flicker.
struct Evidence {
  std::int8_t hit = 40;
  std::int8_t miss = 8;
  std::int8_t graze = 1;         // a ray that only grazes what the cell holds
  std::int8_t min = -20;
  std::int8_t max = 100;
  std::int8_t occupied_at = 20;  // and above: becomes occupied
  std::int8_t free_at = -8;      // and below: becomes free
};

struct GridConfig {
  double cell_m = 0.2;
  double box_m = 32.0;    // side of the box, horizontally
  double height_m = 9.6;  // and its height
  Evidence evidence;
  std::size_t max_points = 12'000;  // of a scan
  FixedVector<BodyBox, 8> body;
};

/// Returns a grid's window about a point.
Window window_about(const Eigen::Vector3d& p_odom, const GridConfig& config);

/// A scan as the grid takes it in.
/// Frames: points in imu at the scan's end; the rays' origin in odom.
struct CarvingScan {
  std::span<const Eigen::Vector3f> points_imu;
  geometry::Se3 T_odom_imu;
  geometry::Se3 T_odom_base;
  Eigen::Vector3d origin_odom = Eigen::Vector3d::Zero();  // of the rays: the lidar, at the scan's middle
};

/// Occupied, free and unknown cells in a box around the robot: rays carve, their ends fill.
///
/// A ray carves one cell in each layer across its longest axis, those at whole cells from its origin: corners that it only cuts stay.
/// Within a scan a cell that was hit is not carved by the scan's other rays, whatever their order. A cell holds the place of
/// its last hit: a ray that passes by farther than half a cell, or ends within two cells, only grazes what is there (ground
/// at low angles, edges) and weighs an eighth. Each cell is hit or missed once a scan. Cells inside the robot's body are free.
/// Source: log-odds after [Thrun05] 9.2; where in a cell its surface lies decides about a miss as in Saarinen et al., "3D
/// normal distributions transform occupancy maps", 2013.
/// Frames: odom.  Memory: 1.9 kB a block, sized once.
/// Real-time: allocates in the constructor only; O(points · cells of a ray); one thread.
class RollingGrid {
 public:
  explicit RollingGrid(const GridConfig& config);

  /// What it keeps of each block.
  static const std::size_t kBlock_bytes;

  /// Takes a scan in; the window follows the robot when it is more than a block from its middle. Points beyond max_points
  /// are left out.
  void insert(const CarvingScan& scan);

  /// Forgets everything; the window is about this point now.
  void restart(const Eigen::Vector3d& p_odom);

  const StateMap& states() const { return states_; }
  const ChangeOrder& changes() const { return changes_; }

  /// Sum of BlockStates::digest().
  std::uint64_t digest() const { return digest_; }

  /// Which of the submaps was the newest when the block changed last.
  std::int32_t submap(std::uint32_t slot) const { return submaps_[slot]; }

  /// Blocks that change from now on belong to this submap.
  void set_submap(std::int32_t id) { submap_ = id; }

 private:
  using Words = std::array<std::uint64_t, kBlockSide>;  // a bit a cell, as in BlockStates

  /// What only the carver needs of a block.
  struct Block {
    std::array<std::int8_t, kBlockCells> evidence{};
    std::array<std::uint16_t, kBlockCells> hit_place{};  // of the last hit: 5 bits an axis
    Words solid{};    // evidence above zero
    Words settled{};  // evidence at its minimum: another miss says nothing
    // Of the scan under way:
    Words hits{};
    Words misses{};
    Words grazes{};
    std::uint32_t scan = 0;  // the last one that touched it
  };

  void follow(const Eigen::Vector3d& p_odom);
  void enter(std::uint32_t slot);
  Block& touch(std::uint32_t slot);
  void mark_hits(const CarvingScan& scan);
  void carve(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool ends_inside);
  void carve_body(const geometry::Se3& T_odom_base);
  void apply(std::uint32_t slot);

  Eigen::Vector3d first_corner() const;
  bool is_inside(const Eigen::Vector3f& local) const;
  Eigen::Vector3f clipped(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

  GridConfig config_;
  StateMap states_;
  ChangeOrder changes_;
  std::uint64_t digest_ = 0;
  std::int32_t submap_ = -1;
  BoundedVector<std::int32_t> submaps_;  // per slot
  BoundedVector<Block> blocks_;          // per slot
  std::array<std::int32_t, 3> cells_{};  // of the window, along each axis
  std::array<BoundedVector<std::uint32_t>, 3> slots_;  // what each of a cell's coordinates, from the window's first, adds to its slot
  std::uint32_t scan_ = 0;
  // scratch, sized once
  BoundedVector<Eigen::Vector3f> ends_;  // of the scan's rays, in cells from the window's first corner
  BoundedVector<std::uint32_t> touched_;  // slots
};

}  // namespace slamd::occupancy
