#include "tools/study/disturbance.hpp"

#include <cmath>
#include <cstdio>

namespace slamd::study {

using geometry::Vector6d;
using inertial::Covariance;
using sensor::ImuSample;

namespace {

constexpr double kHeldByGravity = 0.3;
constexpr double kNoiseFactor = 10.0;
constexpr double kDropped = 0.1;  // share of the scans
constexpr std::size_t kDroppedInARow = 5;
constexpr double kScan_s = 0.1;
constexpr Duration kBefore = std::chrono::milliseconds(300);  // what a run's first scan needs

Vector6d box_of(const ErrorSize& size) {
  const double p = size.position_m;
  const double r = size.rotation_deg * M_PI / 180.0;
  return (Vector6d() << p, p, kHeldByGravity * p, kHeldByGravity * r, kHeldByGravity * r, r)
      .finished();
}

double between(double low, double high, psf::Random& random) {
  return low + (high - low) * random.uniform();
}

Eigen::Vector3d drawn_triple(psf::Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return {x, y, z};
}

Eigen::Vector3d drawn_vector(double low, double high, psf::Random& random) {
  const Eigen::Vector3d direction = drawn_triple(random).normalized();
  return between(low, high, random) * direction;
}

}  // namespace

std::string ErrorSize::name() const {
  char text[32];
  std::snprintf(text, sizeof text, "%g m/%g°", position_m, rotation_deg);
  return text;
}

Vector6d drawn_unit_error(psf::Random& random) {
  Vector6d unit;
  for (double& value : unit) {
    value = random.symmetric();
  }
  return unit;
}

Vector6d error_of(const ErrorSize& size, const Vector6d& unit) {
  return box_of(size).cwiseProduct(unit);
}

Covariance covariance_of(const ErrorSize& size) {
  Covariance P = Covariance::Zero();
  P.diagonal().head<6>() = box_of(size).cwiseAbs2() / 3.0;  // of a uniform draw
  return P;
}

Degradation drawn_degradation(const RecordedDrive& drive,
                              std::size_t first,
                              std::size_t scans,
                              psf::Random& random) {
  const simulate::InertialErrors& errors = drive.imu_errors;
  Degradation wrong;
  const Stamp begin = drive.scans[first].begin;
  wrong.bias_step_at = begin + from_seconds(between(0.2, 0.5, random));
  wrong.gyro_bias_radps = drawn_vector(2.0 * M_PI / 180.0, 5.0 * M_PI / 180.0, random);
  wrong.accel_bias_mps2 = drawn_vector(0.1, 0.3, random);
  wrong.gap_begin = begin + from_seconds(between(0.5, 1.5, random));
  wrong.gap_end = wrong.gap_begin + from_seconds(between(0.5, 2.0, random));
  const auto row = static_cast<std::size_t>(
      between(5.0, static_cast<double>(scans - 2 * kDroppedInARow), random));
  for (std::size_t i = 0; i < scans; ++i) {
    const bool single = random.uniform() < kDropped;
    wrong.scan_dropped.push_back(single || (i >= row && i < row + kDroppedInARow));
  }

  const double rate =
      std::sqrt(drive.imu_rate_hz * (kNoiseFactor * kNoiseFactor - 1.0));  // on top of its own
  const Stamp end = drive.scans[first + scans - 1].end + std::chrono::milliseconds(50);
  for (ImuSample sample : drive.imu) {
    if (sample.stamp < begin - kBefore || sample.stamp > end) {
      continue;
    }
    if (sample.stamp >= begin) {
      sample.angular_rate_radps += errors.gyro_noise_radps_sqrthz * rate * drawn_triple(random);
      sample.specific_force_mps2 += errors.accel_noise_mps2_sqrthz * rate * drawn_triple(random);
    }
    if (sample.stamp >= wrong.bias_step_at) {
      sample.angular_rate_radps += wrong.gyro_bias_radps;
      sample.specific_force_mps2 += wrong.accel_bias_mps2;
    }
    if (sample.stamp < wrong.gap_begin || sample.stamp >= wrong.gap_end) {
      wrong.imu.push_back(sample);
    }
  }

  const double added = kNoiseFactor * kNoiseFactor * kScan_s;
  wrong.told_at_scans.diagonal()
      .segment<3>(inertial::kRotation)
      .setConstant(added * errors.gyro_noise_radps_sqrthz * errors.gyro_noise_radps_sqrthz);
  wrong.told_at_scans.diagonal()
      .segment<3>(inertial::kVelocity)
      .setConstant(added * errors.accel_noise_mps2_sqrthz * errors.accel_noise_mps2_sqrthz);
  wrong.told_at_step.diagonal()
      .segment<3>(inertial::kGyroBias)
      .setConstant(wrong.gyro_bias_radps.squaredNorm() / 3.0);
  wrong.told_at_step.diagonal()
      .segment<3>(inertial::kAccelBias)
      .setConstant(wrong.accel_bias_mps2.squaredNorm() / 3.0);
  return wrong;
}

Covariance Degradation::told_at(Stamp scan_end) {
  const bool step = !step_told && scan_end >= bias_step_at;
  step_told = step_told || step;
  return step ? Covariance(told_at_scans + told_at_step) : told_at_scans;
}

}  // namespace slamd::study
