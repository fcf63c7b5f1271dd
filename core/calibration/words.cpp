#include "core/calibration/words.hpp"

#include <cmath>
#include <cstdio>

#include "core/geometry/so3.hpp"

namespace slamd::calibration {

namespace {

// Less is not worth a change.
constexpr double kLeastOffset_s = 1e-3;
constexpr double kLeastRotation_rad = 1.0 * M_PI / 180.0;
constexpr double kLeastLean_rad = 3.0 * M_PI / 180.0;

double degrees(double rad) { return rad * 180.0 / M_PI; }

template <typename... Arguments>
std::string printed(const char* format, Arguments... arguments) {
  char text[240];
  std::snprintf(text, sizeof text, format, arguments...);
  return text;
}

}  // namespace

std::string in_tenths(double value) { return printed("%.1f", std::round(10.0 * value) / 10.0 + 0.0); }

std::string rpy_in_words(const Eigen::Vector3d& rpy_deg) {
  return "[" + in_tenths(rpy_deg.x()) + ", " + in_tenths(rpy_deg.y()) + ", " + in_tenths(rpy_deg.z()) + "]";
}

std::string offset_in_words(const LidarImuAgreement& agreement) {
  if (!agreement.known) {
    return printed("not known to a millisecond after %d windows of 10 s", agreement.windows);
  }
  return printed("%.1f ms %s (1σ %.1f ms)", 1e3 * std::abs(agreement.offset_s.value),
                 agreement.offset_s.value < 0.0 ? "early" : "late", 1e3 * agreement.offset_s.std);
}

std::vector<std::string> complaints(const SensorAgreement& agreement, double offset_s, const geometry::Se3& T_base_imu) {
  std::vector<std::string> lines;
  const LidarImuAgreement& imu = agreement.lidar_imu;
  if (imu.known && imu.offset_s.stands_out(kLeastOffset_s)) {
    lines.push_back("imu stamps are " + offset_in_words(imu) +
                    printed(": imu.offset_ms = %.1f", 1e3 * (offset_s + imu.offset_s.value)));
  }
  // An axis that the drive hardly shows, as that of level turns, has a deviation that is not to be trusted either.
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  std::string axes;
  for (int axis = 0; imu.known && axis < 3; ++axis) {
    const Estimate& about = imu.rotation_rad[static_cast<std::size_t>(axis)];
    if (about.stands_out(kLeastRotation_rad) && about.std < kLeastRotation_rad / 4.0) {
      rotation_rad[axis] = about.value;
      axes += printed("%s%.1f° about %c", axes.empty() ? "" : ", ", degrees(about.value), "xyz"[axis]);
    }
  }
  if (!axes.empty()) {
    // What the sensor says is turned by −rotation against where it is believed to be.
    const Eigen::Matrix3d R = T_base_imu.rotation() * geometry::so3_exp(Eigen::Vector3d(-rotation_rad));
    lines.push_back("imu turned " + axes + ": imu.T_base_imu rpy_deg = " + rpy_in_words(geometry::rpy_from_rotation(R) * 180.0 / M_PI));
  }
  const GravityAgreement& gravity = agreement.gravity;
  if (gravity.known && (gravity.roll_rad.stands_out(kLeastLean_rad) || gravity.pitch_rad.stands_out(kLeastLean_rad))) {
    lines.push_back(printed("base leans %.1f° roll, %.1f° pitch to gravity: T_base_imu, T_base_lidar right?",
                            degrees(gravity.roll_rad.value), degrees(gravity.pitch_rad.value)));
  }
  return lines;
}

}  // namespace slamd::calibration
