#pragma once

#include <array>

#include "core/calibration/agreement.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::calibration {

/// Holds base against the vertical over a drive: slopes and bumps come and go, a sensor that is mounted otherwise than the
/// configuration says stays. The way counts, not the time, so that a rest on a ramp is one place among many; deviations come from
/// how parts of the way disagree.
/// Real-time: no allocation; O(1).
class GravityCheck {
 public:
  /// Takes in where base is and where the vertical is believed to be, both in odom.
  void add(const geometry::Se3& T_odom_base, const Eigen::Vector3d& up_odom);

  GravityAgreement agreement() const;

 private:
  static constexpr int kParts = 10;
  static constexpr double kPart_m = 10.0;
  static constexpr double kLeastWay_m = 50.0;

  struct Part {
    double way_m = 0.0;
    Eigen::Vector2d lean = Eigen::Vector2d::Zero();  // roll and pitch, times the way
  };

  bool begun_ = false;
  Eigen::Vector3d last_odom_ = Eigen::Vector3d::Zero();
  std::array<Part, kParts> parts_{};
  int part_ = 0;
};

}  // namespace slamd::calibration
