#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"
#include "core/psf/random.hpp"
#include "core/sensor/imu_sample.hpp"
#include "tools/study/recorded_drive.hpp"

namespace slamd::study {

/// How large an error of the prediction is drawn: uniformly up to so much in x, y and yaw, and up
/// to 0.3 of it in z, roll and pitch, which gravity holds (methods.md 1.4).
struct ErrorSize {
  double position_m = 0.0;
  double rotation_deg = 0.0;

  std::string name() const;
};

/// Draws the error's place in its box, each in [-1, 1): the same for every size and estimator.
geometry::Vector6d drawn_unit_error(psf::Random& random);

/// Scales a place in the box to an error. Frames: (δp, δθ) of T_odom_imu.
geometry::Vector6d error_of(const ErrorSize& size, const geometry::Vector6d& unit);

/// The covariance of what is drawn: what a filter is told of it.
inertial::Covariance covariance_of(const ErrorSize& size);

/// What is wrong with the inertial sensor and the scans during one run: white noise of ten times
/// its density, a step of the biases (2 to 5 °/s, 0.1 to 0.3 m/s²), a gap of 0.5 to 2 s, every
/// tenth scan and five in a row missing.
struct Degradation {
  Stamp bias_step_at{};
  Eigen::Vector3d gyro_bias_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_mps2 = Eigen::Vector3d::Zero();
  Stamp gap_begin{};
  Stamp gap_end{};
  std::vector<bool> scan_dropped;
  std::vector<sensor::ImuSample> imu;  // of the run, as it is now
  // What a filter is told: what the noise adds during a scan, and the steps of the biases once.
  inertial::Covariance told_at_scans = inertial::Covariance::Zero();
  inertial::Covariance told_at_step = inertial::Covariance::Zero();
  bool step_told = false;

  /// Returns what is to be told before a scan that ends then.
  inertial::Covariance told_at(Stamp scan_end);
};

/// Draws what goes wrong in the `scans` scans from `first` on, and spoils the samples.
Degradation drawn_degradation(const RecordedDrive& drive,
                              std::size_t first,
                              std::size_t scans,
                              psf::Random& random);

}  // namespace slamd::study
