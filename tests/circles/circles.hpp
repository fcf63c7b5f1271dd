#pragma once

#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/so3.hpp"
#include "core/mapping/mapper.hpp"
#include "tests/world/room.hpp"

namespace slamd::circles {

using geometry::Se3;

inline constexpr double kStep_m = 0.2;
inline constexpr double kRadius_m = 3.0;
inline constexpr double kDrift_rad = 0.0015;  // a step, to one side

/// A small map that keeps up with such a drive.
inline mapping::MapperConfig small() {
  mapping::MapperConfig config;
  config.keyframes = 120;
  config.use_gravity = false;
  config.loops = 64;
  config.points_a_cloud = 2'000;
  config.scans_a_cloud = 3;
  config.submap_m = 6.0;
  config.quiet_m = 2.0;
  config.novelty.recent_m = config.proximity.recent_m = config.proximity.apart_m = 10.0;
  config.appearance.recent_m = config.appearance.apart_m = 10.0;
  config.neighbours_m = 3.0;
  config.back_end.factor_entries = 200'000;
  return config;
}

/// A drive in circles through a hall, by an odometry that turns a little too far at each step and says so.
class Circles {
 public:
  Circles() { step(); }

  Se3 T_true() const {
    const double angle = kStep_m * steps_ / kRadius_m;
    return {geometry::rotation_from_rpy({0.0, 0.0, angle + M_PI_2}), {kRadius_m * std::cos(angle), kRadius_m * std::sin(angle) + 0.5, 1.0}};
  }

  /// Drives on by one scan.
  mapping::MappedScan step() {
    const Se3 before = T_true();
    ++steps_;
    const Se3 wrong_turn(geometry::so3_exp({0.0, 0.0, kDrift_rad}), Eigen::Vector3d::Zero());
    T_odom_base_ = T_odom_base_ * (before.inverse() * T_true()) * wrong_turn;
    motion_.T_odom_base = T_odom_base_;
    motion_.drift_base.setZero();
    motion_.drift_base.diagonal() << 1e-6, 1e-6, 1e-6, 1e-8, 1e-8, 4e-5;
    motion_.drift_base.topLeftCorner<3, 3>() += lost_std_m_ * lost_std_m_ * Eigen::Matrix3d::Identity();
    lost_std_m_ = 0.0;
    points_ = room_.points_lidar(T_true(), 150, 0.01, engine_);
    mapping::MappedScan scan;
    scan.stamp = Stamp{} + steps_ * std::chrono::milliseconds(100);
    scan.T_odom_base = scan.T_odom_imu = T_odom_base_;
    scan.indoor = scan.trusted = true;
    scan.motion = motion_;
    scan.points_imu = points_;
    return scan;
  }

  /// The odometry is off by so much at once, and says how uncertain it was.  Units: m.
  void lose_the_way(const Eigen::Vector3d& off_odom, double std_m) {
    T_odom_base_.translation() += off_odom;
    lost_std_m_ = std_m;
  }

  /// How far a pose of the newest scan is off, map being where it is at the first scan.
  double error_m(const Se3& T_map_base) const {
    return ((T_first_.inverse() * T_true()).translation() - T_map_base.translation()).norm();
  }

  const Se3& T_odom_base() const { return T_odom_base_; }

 private:
  world::Room room_;
  std::mt19937_64 engine_{5};
  int steps_ = 0;
  Se3 T_first_ = T_true();
  Se3 T_odom_base_;
  double lost_std_m_ = 0.0;
  odometry::MotionStep motion_;
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace slamd::circles
