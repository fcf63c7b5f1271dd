#include "core/calibration/lidar_imu_check.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/geometry/so3.hpp"

namespace slamd::calibration {

using geometry::Matrix6d;
using geometry::skew;
using geometry::so3_exp;
using geometry::so3_log;
using inertial::kErrorStates;
using inertial::NavState;

namespace {

// What the parameters may be before anything is seen.
constexpr double kOffsetStd_s = 0.05;
constexpr double kRotationStd_rad = 0.1;
constexpr double kScaleStd = 0.01;

// A scan pulls less than its normal equations say: a point that is off finds neighbours that are off with it. Measured by
// associating anew half a milliradian beside the posterior: 0.77 (campus) to 0.88 (indoor) of the gradient expected.
constexpr double kPull = 0.9;

// Share of what a scan meets that was laid by the scans of the last moments, wrong as they were.
constexpr double kMapRenewal = 0.05;

// Correlation of attitude differences from a scan to the next.
constexpr double kWhitening = 0.8;

// What a drive does not tell: kPull is not the same everywhere, and a rotation hides behind what the map holds.
constexpr double kOffsetShareStd = 0.05;
constexpr double kLeastOffsetStd_s = 2e-4;
constexpr double kLeastRotationStd_rad = 2e-3;
constexpr double kKnownOffsetStd_s = 1e-3;

constexpr double kLeastAttitudeStd_rad = 1e-4;  // of a whitened difference

}  // namespace

void LidarImuCheck::begin(const NavState& state) {
  V_.setZero();
  V_.block<3, 1>(inertial::kPosition, kOffset) = state.v_odom_imu;
  // A turned sensor levels odom along what it feels: the vertical leans with it.
  V_.block<2, 3>(inertial::kGravity, kRotation) =
      inertial::tangent_basis(state.g_odom).transpose() * state.T_odom_imu.rotation();
  V_map_.setZero();
  open_window(state);
}

void LidarImuCheck::add(const ScanStep& step) {
  const double dt_s = to_seconds(step.predicted.stamp - step.before.stamp);
  if (dt_s <= 0.0) {
    return;
  }
  const Eigen::Vector3d turn =
      so3_log(step.before.T_odom_imu.rotation().transpose() * step.predicted.T_odom_imu.rotation());
  follow_errors(step, turn, dt_s);

  R_odom_gyro_ = geometry::orthonormalized(R_odom_gyro_ * so3_exp(turn + (step.before.gyro_bias - gyro_bias_) * dt_s));
  gyro_sensitivity_odom_.middleCols<3>(kRotation) -= R_odom_gyro_ * skew(turn);
  gyro_sensitivity_odom_.middleCols<3>(kScale) += R_odom_gyro_ * turn.asDiagonal();
  elapsed_s_ += dt_s;
  Rows rows;
  rows.leftCols<kParameters>() = gyro_sensitivity_odom_ - R_odom_gyro_ * V_.middleRows<3>(inertial::kRotation);
  rows.rightCols<1>() = so3_log(R_odom_gyro_ * step.posterior.T_odom_imu.rotation().transpose());
  add_rows(rows);
  if (elapsed_s_ >= kWindow_s) {
    close_window();
    open_window(step.posterior);
  }
}

// The scan's update pulls the errors to those of the map, in the mean of the scan's time.
void LidarImuCheck::follow_errors(const ScanStep& step, const Eigen::Vector3d& turn, double dt_s) {
  const Eigen::Matrix3d& R = step.predicted.T_odom_imu.rotation();
  const Eigen::Vector3d push_odom = step.predicted.v_odom_imu - step.before.v_odom_imu - step.before.g_odom * dt_s;
  V_ = (step.transition.topLeftCorner<kErrorStates, kErrorStates>() * V_).eval();
  V_.block<3, 3>(inertial::kRotation, kRotation) -= skew(turn);
  V_.block<3, 3>(inertial::kVelocity, kRotation) -= skew(push_odom) * R;
  V_.block<3, 3>(inertial::kRotation, kScale).diagonal() += turn;

  PoseSensitivity in_scan = V_.topRows<6>();
  in_scan.block<3, 1>(inertial::kPosition, kOffset) -= 0.5 * (step.before.v_odom_imu + step.predicted.v_odom_imu);
  in_scan.block<3, 1>(inertial::kRotation, kOffset) -= turn / dt_s;
  in_scan.block<3, 3>(inertial::kRotation, kRotation) += 0.5 * skew(turn);
  in_scan.block<3, 3>(inertial::kRotation, kScale).diagonal() -= 0.5 * turn;

  const PoseSensitivity pull = kPull * step.information * (in_scan - V_map_);
  V_.noalias() -= step.P_posterior.leftCols<6>() * pull;
  V_map_ += kMapRenewal * (in_scan - step.P_posterior.topLeftCorner<6, 6>() * pull - V_map_);
}

void LidarImuCheck::open_window(const NavState& state) {
  R_odom_gyro_ = state.T_odom_imu.rotation();
  gyro_bias_ = state.gyro_bias;
  gyro_sensitivity_odom_.setZero();
  elapsed_s_ = count_ = sum_t_ = sum_tt_ = 0.0;
  sum_rows_.setZero();
  sum_t_rows_.setZero();
  sum_squares_.setZero();
}

void LidarImuCheck::add_rows(const Rows& rows) {
  if (count_ == 0.0) {
    last_rows_ = rows;
  }
  const Rows white = rows - kWhitening * last_rows_;
  last_rows_ = rows;
  count_ += 1.0;
  sum_t_ += elapsed_s_;
  sum_tt_ += elapsed_s_ * elapsed_s_;
  sum_rows_ += white;
  sum_t_rows_ += elapsed_s_ * white;
  sum_squares_ += white.transpose() * white;
}

void LidarImuCheck::close_window() {
  if (count_ < 10.0) {
    return;
  }
  Eigen::Matrix2d N;
  N << count_, sum_t_, sum_t_, sum_tt_;
  const Eigen::LDLT<Eigen::Matrix2d> solver(N);
  Window& window = windows_[static_cast<std::size_t>(next_window_)];
  window.moments = sum_squares_;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Matrix<double, 2, kColumns> with;
    with << sum_rows_.row(axis), sum_t_rows_.row(axis);
    window.moments -= with.transpose() * solver.solve(with);
  }
  window.count = 3.0 * count_;
  next_window_ = (next_window_ + 1) % kWindows;
}

LidarImuAgreement LidarImuCheck::agreement() const {
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector = Eigen::Matrix<double, kParameters, 1>;
  LidarImuAgreement agreement;
  Moments sum = Moments::Zero();
  double count = 0.0;
  for (const Window& window : windows_) {
    sum += window.moments;
    count += window.count;
    agreement.windows += window.count > 0.0 ? 1 : 0;
  }
  if (agreement.windows == 0) {
    return agreement;
  }
  Vector prior_std;
  prior_std << kOffsetStd_s, kRotationStd_rad, kRotationStd_rad, kRotationStd_rad, kScaleStd, kScaleStd, kScaleStd;
  // Twice: the residuals tell how much the prior counts against them.
  double variance = kLeastAttitudeStd_rad * kLeastAttitudeStd_rad;
  Matrix information;
  Vector estimate;
  for (int pass = 0; pass < 2; ++pass) {
    information = sum.topLeftCorner<kParameters, kParameters>() / variance;
    information.diagonal() += prior_std.cwiseAbs2().cwiseInverse();
    estimate = information.ldlt().solve(sum.topRightCorner<kParameters, 1>() / variance);
    Eigen::Matrix<double, kColumns, 1> residual;
    residual << -estimate, 1.0;
    variance = std::max(variance, residual.dot(sum * residual) / count);
  }
  Matrix disagreement = Matrix::Zero();
  for (const Window& window : windows_) {
    const Vector score = (window.moments.topRightCorner<kParameters, 1>() -
                          window.moments.topLeftCorner<kParameters, kParameters>() * estimate) / variance;
    disagreement += score * score.transpose();
  }
  const Matrix P = information.ldlt().solve(Matrix::Identity());
  const Matrix P_robust = P * disagreement * P;
  const auto of = [&](int i, double least_std) {
    return Estimate{estimate[i], std::sqrt(std::max(P(i, i), P_robust(i, i)) + least_std * least_std)};
  };
  agreement.offset_s = of(kOffset, std::max(kLeastOffsetStd_s, kOffsetShareStd * std::abs(estimate[kOffset])));
  for (int axis = 0; axis < 3; ++axis) {
    agreement.rotation_rad[static_cast<std::size_t>(axis)] = of(kRotation + axis, kLeastRotationStd_rad);
  }
  agreement.known = agreement.windows >= kLeastWindows && agreement.offset_s.std < kKnownOffsetStd_s;
  return agreement;
}

}  // namespace slamd::calibration
