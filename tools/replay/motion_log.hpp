#pragma once

#include <cstdio>
#include <deque>
#include <vector>

#include "core/evaluation/nees.hpp"
#include "core/odometry/motion_covariance.hpp"

namespace slamd::replay {

/// Claims the covariance of each motion of some length: from a scan to the first one by which so much path was driven.
/// Motions begin each kSpacing_m of path, so that standing does not count.
class MotionLog {
 public:
  static constexpr double kLength_m = 10.0;
  static constexpr double kSpacing_m = 0.1;

  void add(Stamp stamp, const odometry::MotionStep& step);

  const std::vector<evaluation::MotionClaim>& claims() const { return claims_; }

 private:
  struct Begun {
    Stamp stamp{};
    double path_m = 0.0;
    odometry::MotionCovariance covariance;
  };

  std::deque<Begun> begun_;
  std::vector<evaluation::MotionClaim> claims_;
  geometry::Se3 T_odom_last_;
  double path_m_ = 0.0;
  bool any_ = false;
};

/// Writes claims as motions.csv: the stamp of the last scan, how much earlier the first was, the covariance.
void write_motions(std::FILE* file, const std::vector<evaluation::MotionClaim>& claims);

}  // namespace slamd::replay
