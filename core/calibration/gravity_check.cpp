#include "core/calibration/gravity_check.hpp"

#include <cmath>

namespace slamd::calibration {

namespace {

constexpr double kStill_m = 0.02;         // a step that noise makes is no way
constexpr double kLeastLeanStd_rad = 5e-3;

}  // namespace

void GravityCheck::add(const geometry::Se3& T_odom_base, const Eigen::Vector3d& up_odom) {
  const Eigen::Vector3d place = T_odom_base.translation();
  const double step_m = (place - last_odom_).norm();
  if (!begun_ || step_m < kStill_m) {
    last_odom_ = begun_ ? last_odom_ : place;
    begun_ = true;
    return;
  }
  last_odom_ = place;
  const Eigen::Vector3d up_base = T_odom_base.rotation().transpose() * up_odom;
  if (parts_[static_cast<std::size_t>(part_)].way_m >= kPart_m) {
    part_ = (part_ + 1) % kParts;
    parts_[static_cast<std::size_t>(part_)] = Part{};
  }
  Part& part = parts_[static_cast<std::size_t>(part_)];
  part.way_m += step_m;
  part.lean += step_m * Eigen::Vector2d(std::atan2(up_base.y(), up_base.z()), -std::atan2(up_base.x(), up_base.z()));
}

GravityAgreement GravityCheck::agreement() const {
  GravityAgreement agreement;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Part& part : parts_) {
    agreement.way_m += part.way_m;
    sum += part.lean;
  }
  if (agreement.way_m < kLeastWay_m) {
    return agreement;
  }
  const Eigen::Vector2d mean = sum / agreement.way_m;
  Eigen::Vector2d variance = Eigen::Vector2d::Zero();
  for (const Part& part : parts_) {
    variance += (part.lean - part.way_m * mean).cwiseAbs2() / (agreement.way_m * agreement.way_m);
  }
  variance.array() += kLeastLeanStd_rad * kLeastLeanStd_rad;
  agreement.roll_rad = {mean.x(), std::sqrt(variance.x())};
  agreement.pitch_rad = {mean.y(), std::sqrt(variance.y())};
  agreement.known = true;
  return agreement;
}

}  // namespace slamd::calibration
