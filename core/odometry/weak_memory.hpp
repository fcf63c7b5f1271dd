#pragma once

#include <optional>

#include "core/geometry/se3.hpp"
#include "core/geometry/so3.hpp"
#include "core/odometry/localisability.hpp"

namespace slamd::odometry {

/// Remembers which way was not seen, until scans that fit the map well have seen it for a while.
///
/// Where a direction is not seen the map may lose its sharpness, and a map that has lost it seems to show the direction:
/// its normals point anywhere. What it says along there is not to be believed, however much it is.
/// Frames: odom. The direction turns with a vehicle that follows a gentle bend, as the axis of a tunnel does, and stays
/// where it is when the vehicle turns about.
/// Real-time: never allocates; one thread.
class WeakMemory {
 public:
  static constexpr double kBlindWay_m = 20.0;    // with the direction unseen: until then the map is sharp
  static constexpr int kFittingScans = 30;       // in a row
  static constexpr double kFittingRatio = 0.86;  // of the features that meet the map, and of those within the kernel
  static constexpr double kClearShare = 0.15;    // of the information: such a direction is seen whatever the map is like
  static constexpr double kMostBend_1pm = 0.02;  // of a bend that is gentle

  /// The direction, as long as it is remembered.
  std::optional<Eigen::Vector3d> direction_odom() const {
    return blind_way_m_ >= kBlindWay_m ? std::optional<Eigen::Vector3d>(direction_odom_) : std::nullopt;
  }

  /// Takes in what a scan has seen: `fit` is the smaller of its ratios of matched features and of inliers.
  void note(const Localisability& seen, double fit, const geometry::Se3& T_odom_base) {
    const Eigen::Vector3d turn = geometry::so3_log(T_odom_base.rotation() * T_odom_base_.rotation().transpose());
    const double way_m = (T_odom_base.translation() - T_odom_base_.translation()).norm();
    if (turn.norm() < kMostBend_1pm * way_m) {
      direction_odom_ = geometry::so3_exp(turn) * direction_odom_;
    }
    T_odom_base_ = T_odom_base;
    const bool fits = fit >= kFittingRatio;
    if (seen.own_weak != 0) {
      blind_way_m_ += way_m;
      sees_ = 0;
      if (fits || blind_way_m_ < kBlindWay_m) {
        direction_odom_ = seen.weakest_odom;
      }
      return;
    }
    sees_ = fits || seen.remembered_share >= kClearShare ? sees_ + 1 : 0;
    if (sees_ >= kFittingScans) {
      blind_way_m_ = 0.0;
    }
  }

  void clear() { *this = WeakMemory{}; }

 private:
  double blind_way_m_ = 0.0;  // since a direction was last seen for a while
  int sees_ = 0;              // scans in a row
  Eigen::Vector3d direction_odom_ = Eigen::Vector3d::UnitX();
  geometry::Se3 T_odom_base_;  // of the last scan
};

}  // namespace slamd::odometry
