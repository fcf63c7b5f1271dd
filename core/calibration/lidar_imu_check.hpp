#pragma once

#include <array>

#include "core/calibration/agreement.hpp"
#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"

namespace slamd::calibration {

/// One scan's part in the check: how the odometry's filter came from the end of the last scan to the end of this one.
struct ScanStep {
  const inertial::NavState& before;        // at the end of the last scan
  const inertial::NavState& predicted;     // at the end of this one
  const inertial::Transition& transition;  // of the errors, up to the prediction
  const inertial::NavState& posterior;
  const inertial::Covariance& P_posterior;
  geometry::Matrix6d information;  // of the scan, in (δp, δθ), as the update took it
};

/// Estimates, beside the odometry and without touching it, by how much inertial stamps are late against the LiDAR's, and
/// by how much the inertial sensor is turned against the place that the configuration gives it.
///
/// The gyroscope alone, carried on for ten seconds, is held against the attitudes that the odometry found. Where they
/// part as the turn rate does, stamps are late; where they part about an axis across the turn, the sensor is turned.
/// The odometry has been led by the same samples: how its errors hang on the parameters is carried through its own
/// transitions and gains and taken into account (bias separation after Friedland, "Treatment of bias in recursive filtering",
/// 1969). A scan, deskewed by the same samples, holds the attitude of its mean time, so that no rate of a single
/// moment enters. Within a window a constant and a drift are free (Frisch and Waugh, 1933), and the differences are whitened
/// as a first-order process (Prais and Winsten, 1954). Standard deviations come from the residuals and from how the windows
/// disagree (cluster-robust: Liang and Zeger, 1986), not from what the filter believes.
/// Real-time: no allocation; O(17² · 7) a scan, 3 · 8² · 2 a window.
class LidarImuCheck {
 public:
  /// Begins a window anew where nothing is known of what went before: at the start, or when the thread was lost. What
  /// earlier windows have shown stays.
  void begin(const inertial::NavState& state);

  /// Takes in a scan whose update stands.
  void add(const ScanStep& step);

  /// Solves for what the windows of the last minutes have shown.
  LidarImuAgreement agreement() const;

 private:
  // The parameters: s that stamps are late; rad that the sensor is turned, in its axes; share that each of
  // the gyroscope's axes says too much, which is kept apart from the others and not told.
  static constexpr int kOffset = 0;
  static constexpr int kRotation = 1;
  static constexpr int kScale = 4;
  static constexpr int kParameters = 7;
  static constexpr int kColumns = kParameters + 1;  // and what is to be explained by them
  static constexpr int kWindows = 12;
  static constexpr int kLeastWindows = 4;
  static constexpr double kWindow_s = 10.0;

  using Sensitivity = Eigen::Matrix<double, inertial::kErrorStates, kParameters>;
  using PoseSensitivity = Eigen::Matrix<double, 6, kParameters>;
  using Rows = Eigen::Matrix<double, 3, kColumns>;
  using Moments = Eigen::Matrix<double, kColumns, kColumns>;

  /// What is left of the rows' squares once a constant and a drift are taken out.
  struct Window {
    Moments moments = Moments::Zero();
    double count = 0.0;
  };

  void follow_errors(const ScanStep& step, const Eigen::Vector3d& turn, double dt_s);
  void open_window(const inertial::NavState& state);
  void add_rows(const Rows& rows);
  void close_window();

  // Of the filter's errors by the parameters. In the offset's column the motion itself is added, V + ẋ: a state that is
  // late is where it was, and V + ẋ needs no rates.
  Sensitivity V_ = Sensitivity::Zero();
  PoseSensitivity V_map_ = PoseSensitivity::Zero();  // the same of the poses that the map around was laid at

  Eigen::Matrix3d R_odom_gyro_ = Eigen::Matrix3d::Identity();  // by the gyroscope alone since the window's begin
  Eigen::Vector3d gyro_bias_ = Eigen::Vector3d::Zero();        // as it was then
  Eigen::Matrix<double, 3, kParameters> gyro_sensitivity_odom_ = Eigen::Matrix<double, 3, kParameters>::Zero();
  Rows last_rows_ = Rows::Zero();
  double elapsed_s_ = 0.0;
  double count_ = 0.0;
  double sum_t_ = 0.0;
  double sum_tt_ = 0.0;
  Rows sum_rows_ = Rows::Zero();
  Rows sum_t_rows_ = Rows::Zero();
  Moments sum_squares_ = Moments::Zero();

  std::array<Window, kWindows> windows_{};
  int next_window_ = 0;
};

}  // namespace slamd::calibration
