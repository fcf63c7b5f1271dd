#pragma once

#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/base/stamp.hpp"
#include "core/inertial/nav_state.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/point.hpp"

namespace slamd::scan {

/// The motion during one scan: T_end_t, from the imu at time t to the imu at the scan's end, on a fine grid.
/// Source: full SE(3) at each point's own time (design.md, "Deskew"), where LIO-SAM turns only and LOAM assumes
/// constant velocity.
/// Real-time: allocates in the constructor only.
class ScanMotion {
 public:
  /// Spacing of the poses; each comes from the inertial samples, a point between two from interpolation.
  static constexpr Duration kGridStep = std::chrono::milliseconds(1);

  explicit ScanMotion(Duration longest_scan);

  /// Predicts the motion over [begin, end] from an earlier state. With an empty `samples` at constant velocity
  /// (gyro_bias then holds −ω; see propagate_constant_velocity).
  void predict(const inertial::NavState& earlier,
               std::span<const sensor::ImuSample> samples,
               Stamp begin,
               Stamp end);

  /// Declares that there was none: every point keeps its place.
  void set_still(Stamp begin, Stamp end);

  /// Returns a point of the imu at `offset_ns` after the scan's begin, as seen from the imu at the scan's end.
  /// Frames: p_imu at its own time → p_imu at the scan's end.  Units: m.
  Eigen::Vector3f to_end(const Eigen::Vector3f& p_imu, std::uint32_t offset_ns) const;

  Stamp begin() const { return begin_; }
  Stamp end() const { return end_; }

  /// Returns how far the imu turned and moved over the scan. Units: rad, m.
  double turned_rad() const;
  double moved_m() const;

 private:
  struct GridPose {
    Eigen::Matrix3f R;
    Eigen::Vector3f t;
  };

  Stamp begin_{};
  Stamp end_{};
  BoundedVector<geometry::Se3> T_odom_grid_;  // scratch, sized once
  BoundedVector<GridPose> T_end_grid_;
};

}  // namespace slamd::scan
