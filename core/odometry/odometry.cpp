#include "core/odometry/odometry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/so3.hpp"

namespace slamd::odometry {

using geometry::Matrix6d;
using geometry::Se3;
using inertial::kGyroBias;
using inertial::kPosition;
using inertial::kRotation;
using inertial::kVelocity;
using inertial::NavState;
using scan::DeskewedScan;

namespace {

/// Three samples that say the same large value to the last bit are a sensor at its limit, whatever that is.
bool is_saturated(std::span<const sensor::ImuSample> samples) {
  constexpr double kLeastRate_radps = 1.0;
  constexpr double kLeastForce_mps2 = 12.0;
  const auto stuck = [](double a, double b, double c, double least) { return a == b && b == c && std::abs(a) > least; };
  for (std::size_t i = 2; i < samples.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (stuck(samples[i - 2].angular_rate_radps[axis], samples[i - 1].angular_rate_radps[axis],
                samples[i].angular_rate_radps[axis], kLeastRate_radps) ||
          stuck(samples[i - 2].specific_force_mps2[axis], samples[i - 1].specific_force_mps2[axis],
                samples[i].specific_force_mps2[axis], kLeastForce_mps2)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

Odometry::Odometry(const OdometryConfig& config)
    : config_(config),
      map_(config.map),
      psf_(config.psf, config.seed),
      environment_(config.environment, config.indoor_below_m, config.outdoor_above_m),
      wheels_(config.wheel),
      zero_velocity_(config.zero_velocity),
      association_(config.preprocess),
      points_odom_(config.preprocess.max_map_points),
      swarm_points_imu_(config.psf.points) {}

void Odometry::start(const inertial::Alignment& alignment) {
  begin();
  state_ = alignment.state;
  P_ = alignment.P;
  last_corrected_ = state_.stamp;
  lidar_imu_check_.begin(state_);
}

void Odometry::begin() {
  started_ = true;
  map_.clear();
  psf_.reset();
  rate_imu_radps_.setZero();
  wheels_.separate(0, inertial::kErrorStates);  // the scale is the vehicle's, and stays
  waiting_gyro_bias_.setZero();
  coasting_ = between_scans_ = false;
  path_m_ = 0.0;
  bad_scans_ = 0;
  confirmed_ = true;
  was_weak_ = false;
  weak_memory_.clear();
  agreeing_scans_ = unconfirmed_scans_ = unmet_scans_ = restart_said_ = 0;
  last_scan_end_ = Stamp{};
  motion_ = MotionStep{};
  drift_ = SurroundingsDrift{};
  seen_scale_std_ = 0.0;
  shared_errors_.setZero();
}

void Odometry::start_without_imu(Stamp stamp) {
  begin();
  state_ = NavState{};
  state_.stamp = last_corrected_ = stamp;
  P_.setIdentity();
  P_ *= 1e-8;
  P_.diagonal().segment<3>(kVelocity).setConstant(25.0);   // up to a vehicle's pace at once
  P_.diagonal().segment<3>(kGyroBias).setConstant(0.25);   // −ω: see propagate_constant_velocity
}

// The whole of the odometry, a line a step (design.md, "Odometry: the adapted particle swarm filter").
OdometryResult Odometry::process(const DeskewedScan& scan,
                                 std::span<const sensor::ImuSample> samples,
                                 std::span<const sensor::WheelSample> wheels) {
  environment_.add(scan.median_range_m);
  if (!between_scans_) {
    wheels_.begin_transition();
  }
  const bool after_silence = std::exchange(between_scans_, false);
  zero_velocity_.release();
  const NavState before = state_;
  const Cause prediction_cause = predict(scan.end, samples, wheels);             // 1
  if (map_.empty()) {
    last_scan_end_ = last_corrected_ = scan.end;
    extend_map(scan);
    UpdateResult nothing;
    nothing.state = state_;
    nothing.P = P_;
    return result_of(scan, prediction_cause, nothing);
  }
  if (after_silence || lost_the_thread(scan, prediction_cause)) {
    confirmed_ = false;
    agreeing_scans_ = 0;
  }
  last_scan_end_ = scan.end;
  psf::Answer swarm;
  const NavState predicted = state_;
  const inertial::Covariance P_predicted = P_;
  UpdateResult posterior = update(scan, prediction_cause, swarm);          // 1–8
  if (!confirmed_ && posterior.matched_ratio < config_.confirming_matched_ratio) {
    // What little of the old map it meets may be the wrong part of it.
    posterior.state = predicted;
    posterior.P = P_ = P_predicted;
    posterior.enough = false;
  }
  if (!samples.empty() && posterior.enough && is_jump(predicted.T_odom_imu, posterior.state.T_odom_imu)) {
    confirmed_ = false;
    agreeing_scans_ = 0;
  }
  const Cause update_cause = confirm(posterior, judge(posterior));               // 9, 10
  const double moved_m = (posterior.state.T_odom_imu.translation() - state_.T_odom_imu.translation()).norm();
  path_m_ += moved_m;
  if (posterior.enough) {
    last_corrected_ = scan.end;
    weak_memory_.note(posterior.localisability, std::min(posterior.matched_ratio, posterior.inlier_ratio),
                      posterior.state.T_odom_imu * config_.T_base_imu.inverse());
    check_lidar_imu(before, !samples.empty(), posterior);
    wheels_.follow(state_, P_, posterior.state, posterior.P);
  }
  state_ = posterior.state;
  P_ = posterior.P;
  const bool trusted = confirmed_ && (update_cause == Cause::kNone || update_cause == Cause::kDegenerate ||
                                      update_cause == Cause::kMapRestarted);
  if (trusted) {
    extend_map(scan);
  }
  const bool prediction_says_more =
      update_cause == Cause::kNone || (update_cause == Cause::kUnconfirmed && prediction_cause != Cause::kNone);
  OdometryResult result = result_of(scan, prediction_says_more ? prediction_cause : update_cause, posterior);
  result.map_updated = trusted;
  result.swarm = swarm;
  return result;
}

OdometryResult Odometry::go_on_without_scan(Stamp to, std::span<const sensor::ImuSample> samples,
                                            std::span<const sensor::WheelSample> wheels) {
  if (!between_scans_) {
    wheels_.begin_transition();
  }
  between_scans_ = true;
  predict(to, samples, wheels);
  hold_at_rest(samples, wheels);
  OdometryResult result = pose_result(to);
  result.cause = Cause::kNoLidar;
  result.state = is_lost() ? State::kLost : State::kDegraded;
  return result;
}

void Odometry::hold_at_rest(std::span<const sensor::ImuSample> samples, std::span<const sensor::WheelSample> wheels) {
  const NavState predicted = state_;
  const inertial::Covariance P_predicted = P_;
  if (zero_velocity_.update(samples, wheels, config_.imu_noise, state_, P_)) {
    wheels_.follow(predicted, P_predicted, state_, P_);
  }
}

// Beside the odometry: see core/calibration.
void Odometry::check_lidar_imu(const NavState& before, bool by_imu, const UpdateResult& posterior) {
  if (!by_imu || !confirmed_) {
    lidar_imu_check_.begin(posterior.state);
    return;
  }
  lidar_imu_check_.add({before, state_, wheels_.transition(), posterior.state, posterior.P,
                        config_.update.information_share * posterior.information});
}

Cause Odometry::predict(Stamp to,
                        std::span<const sensor::ImuSample> samples,
                        std::span<const sensor::WheelSample> wheels) {
  const Eigen::Vector3d before = state_.T_odom_imu.translation();
  const bool by_imu = !samples.empty();
  Cause cause = by_imu || !config_.use_imu ? Cause::kNone : Cause::kNoImu;
  coast(!by_imu);
  if (pass_unseen(to, samples, wheels)) {
    cause = config_.use_imu ? Cause::kImuGap : cause;
  }
  for (const sensor::WheelSample& wheel : wheels) {
    if (wheel.stamp <= state_.stamp || wheel.stamp > to) {
      continue;
    }
    propagate(wheel.stamp, samples);
    wheels_.update(wheel, config_.T_base_imu, rate_imu_radps_, by_imu, state_, P_);
  }
  propagate(to, samples);
  if (by_imu) {
    for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
      cause = samples[i + 1].stamp - samples[i].stamp > config_.max_imu_gap ? Cause::kImuGap : cause;
    }
    cause = to - samples.back().stamp > config_.max_imu_gap ? Cause::kImuGap : cause;
    cause = is_saturated(samples) ? Cause::kSaturated : cause;
    if (cause == Cause::kImuGap || cause == Cause::kSaturated) {
      // Nobody knows what happened meanwhile.
      P_.diagonal().segment<3>(kVelocity).array() += 0.25;
      P_.diagonal().segment<3>(kPosition).array() += 0.01;
      P_.diagonal().segment<3>(kRotation).array() += 0.01;
    }
  }
  path_m_ += (state_.T_odom_imu.translation() - before).norm();
  return cause;
}

// Where neither inertial sensor nor wheels tell of a long time, integrating the two samples at its ends would be invention.
bool Odometry::pass_unseen(Stamp to, std::span<const sensor::ImuSample> samples, std::span<const sensor::WheelSample> wheels) {
  Stamp heard = to;
  for (const sensor::WheelSample& wheel : wheels) {
    heard = wheel.stamp > state_.stamp ? std::min(heard, wheel.stamp) : heard;
  }
  for (const sensor::ImuSample& sample : samples) {
    heard = sample.stamp > state_.stamp ? std::min(heard, sample.stamp) : heard;
  }
  if (heard - state_.stamp <= inertial::kLongestBridge) {
    return false;
  }
  inertial::propagate_unseen(state_, P_, heard, config_.unseen, &wheels_.followers());
  if (samples.empty()) {
    state_.gyro_bias.setZero();  // it holds −ω here
    rate_imu_radps_.setZero();
  }
  return true;
}

void Odometry::propagate(Stamp to, std::span<const sensor::ImuSample> samples) {
  if (samples.empty()) {
    inertial::propagate_constant_velocity(state_, P_, to, config_.constant_velocity, &wheels_.followers());
    rate_imu_radps_ = -state_.gyro_bias;
    return;
  }
  const inertial::ImuNoise noise = config_.imu_noise.between(state_.stamp - last_corrected_, to - last_corrected_);
  inertial::propagate(state_, P_, samples, to, noise, &wheels_.followers());
  const auto after = std::find_if(samples.begin(), samples.end() - 1, [&](const auto& s) { return s.stamp >= to; });
  rate_imu_radps_ = after->angular_rate_radps - state_.gyro_bias;
}

void Odometry::coast(bool without_imu) {
  if (!config_.use_imu || without_imu == coasting_) {
    return;
  }
  coasting_ = without_imu;
  // Without the sensor b_g holds −ω; the sensor's own bias waits for its return.
  const Eigen::Vector3d gyro_bias = without_imu ? Eigen::Vector3d(-rate_imu_radps_) : waiting_gyro_bias_;
  const double variance = without_imu ? 0.25 : 1e-4;
  waiting_gyro_bias_ = without_imu ? state_.gyro_bias : Eigen::Vector3d(Eigen::Vector3d::Zero());
  state_.gyro_bias = gyro_bias;
  P_.middleRows<3>(kGyroBias).setZero();
  P_.middleCols<3>(kGyroBias).setZero();
  P_.diagonal().segment<3>(kGyroBias).setConstant(variance);
  wheels_.separate(kGyroBias, 3);
}

UpdateResult Odometry::update(const DeskewedScan& scan, Cause prediction_cause, psf::Answer& swarm) {
  const std::optional<Eigen::Vector3d> remembered_weak_odom = weak_memory_.direction_odom();
  const UpdateResult plain = iterated_update(state_, P_, scan, map_, state_.T_odom_imu, config_.update, association_,
                                             remembered_weak_odom);
  if (config_.filter == Filter::kIekf) {
    return plain;
  }
  psf::Question question;
  question.T_odom_imu_prior = state_.T_odom_imu;
  question.P_prior = P_.block<6, 6>(kPosition, kPosition);
  question.T_odom_imu_plain = plain.state.T_odom_imu;
  question.indoor = environment_.indoor();
  question.distrust_prior = !confirmed_ || prediction_cause == Cause::kImuGap || contradiction_of(plain) != Cause::kNone;
  question.scan_index = scan.index;
  swarm = psf_.answer(swarm_points(scan), map_, question);
  if (!swarm.swarm_won) {
    return plain;
  }
  // The winner is where the final EKF update is linearised. Where the prior excludes it, the prior was wrong.
  widen_where_excluded(state_, swarm.T_odom_imu, P_);
  UpdateResult posterior = iterated_update(state_, P_, scan, map_, swarm.T_odom_imu, config_.update, association_,
                                           remembered_weak_odom);
  posterior.innovation = 0.0;  // it was judged by the gate
  return posterior;
}

Cause Odometry::contradiction_of(const UpdateResult& update) const {
  if (!update.enough || update.matched_ratio < config_.min_matched_ratio) {
    return Cause::kFewConstraints;
  }
  if (update.inlier_ratio < config_.min_inlier_ratio) {
    return Cause::kFewInliers;
  }
  if (update.innovation > config_.max_innovation) {
    return Cause::kLargeInnovation;
  }
  return Cause::kNone;
}

// A scan that moves the pose so far from where the inertial sensor has it may have found a wrong place, and where a
// direction is weak, nothing of it has been seen there: so the map must confirm it, too.
bool Odometry::is_jump(const Se3& T_odom_imu_predicted, const Se3& T_odom_imu) const {
  const geometry::Vector6d correction = geometry::boxminus(T_odom_imu, T_odom_imu_predicted);
  return correction.head<3>().norm() > config_.jump_m || correction.tail<3>().norm() > config_.jump_rad;
}

// A map that grows at a wrong pose agrees with it ever after. So after anything that may have moved the vehicle unseen
// the map stays as it was until it has agreed.
bool Odometry::lost_the_thread(const DeskewedScan& scan, Cause prediction_cause) const {
  return prediction_cause == Cause::kSaturated || scan.begin - last_scan_end_ > config_.max_scan_gap ||
         bad_scans_ > config_.lost_after;
}

Cause Odometry::confirm(const UpdateResult& update, Cause update_cause) {
  restart_said_ = std::max(0, restart_said_ - 1);
  if (confirmed_) {
    was_weak_ = update_cause == Cause::kDegenerate;
    unconfirmed_scans_ = unmet_scans_ = 0;
    return update_cause == Cause::kNone && restart_said_ > 0 ? Cause::kMapRestarted : update_cause;
  }
  const bool fits = update_cause == Cause::kNone || (update_cause == Cause::kDegenerate && was_weak_);
  const bool agrees = fits && update.matched_ratio >= config_.confirming_matched_ratio;
  agreeing_scans_ = agrees ? agreeing_scans_ + 1 : 0;
  if (agreeing_scans_ >= config_.confirming_scans) {
    confirmed_ = true;
    return update_cause;
  }
  ++unconfirmed_scans_;
  unmet_scans_ = update.matched_ratio < config_.confirming_matched_ratio ? unmet_scans_ + 1 : 0;
  if (unconfirmed_scans_ < config_.restart_map_after && unmet_scans_ < config_.restart_map_unmet_after) {
    return update_cause == Cause::kNone ? Cause::kUnconfirmed : update_cause;
  }
  confirmed_ = true;
  ++map_restarts_;
  restart_said_ = config_.say_restart_for;
  return Cause::kMapRestarted;
}

Cause Odometry::judge(const UpdateResult& update) const {
  const Cause contradiction = contradiction_of(update);
  return contradiction == Cause::kNone && update.localisability.is_weak() ? Cause::kDegenerate : contradiction;
}

void Odometry::extend_map(const DeskewedScan& scan) {
  const Eigen::Matrix3f R = state_.T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = state_.T_odom_imu.translation().cast<float>();
  points_odom_.clear();
  for (const Eigen::Vector3f& p_imu : scan.map_points_imu) {
    points_odom_.push_back(R * p_imu + t);
  }
  map_.insert(points_odom_.view(), path_m_);
}

std::span<const Eigen::Vector3f> Odometry::swarm_points(const DeskewedScan& scan) {
  swarm_points_imu_.clear();
  const std::size_t features = scan.planar.size() + scan.edge.size();
  const std::size_t wanted = std::min(features, swarm_points_imu_.capacity());
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::size_t i = k * features / wanted;
    swarm_points_imu_.push_back(i < scan.planar.size() ? scan.planar[i].p_imu
                                                       : scan.edge[i - scan.planar.size()].p_imu);
  }
  return swarm_points_imu_.view();
}

Matrix6d Odometry::base_error_by_imu() const {
  // δp_base = δp_imu − R [t]× δθ_imu and δθ_base = R_base_imu δθ_imu.
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() =
      -state_.T_odom_imu.rotation() * geometry::skew(config_.T_base_imu.inverse().translation());
  J.bottomRightCorner<3, 3>() = config_.T_base_imu.rotation();
  return J;
}

OdometryResult Odometry::pose_result(Stamp stamp) const {
  OdometryResult result;
  result.stamp = stamp;
  result.T_odom_imu = state_.T_odom_imu;
  const Se3 T_imu_base = config_.T_base_imu.inverse();
  result.T_odom_base = state_.T_odom_imu * T_imu_base;
  result.v_odom_base =
      state_.v_odom_imu + state_.T_odom_imu.rotation() * rate_imu_radps_.cross(T_imu_base.translation());
  const Matrix6d J = base_error_by_imu();
  result.P_odom_base = J * P_.block<6, 6>(kPosition, kPosition) * J.transpose() + shared_errors_;
  result.up_odom = -state_.g_odom.normalized();
  result.up_std_rad = std::sqrt(P_.diagonal().segment<2>(inertial::kGravity).maxCoeff());
  result.map_restarts = map_restarts_;
  result.indoor = environment_.indoor();
  return result;
}

OdometryResult Odometry::result_of(const DeskewedScan& scan, Cause cause, const UpdateResult& update) {
  const State state = next_state(cause);
  note_uncertainty(static_cast<double>(scan.median_range_m), update);
  OdometryResult result = pose_result(scan.end);
  result.scan_index = scan.index;
  result.cause = cause;
  result.state = state;
  result.localisability = update.localisability;
  if (update.enough) {
    result.weak_axes = weak_axes(update.localisability, Eigen::Matrix3d::Identity());
    result.weak_axes_base = weak_axes(update.localisability, result.T_odom_base.rotation().transpose());
  }
  result.update = update;
  gravity_check_.add(result.T_odom_base, result.up_odom);
  return result;
}

void Odometry::note_uncertainty(double median_range_m, const UpdateResult& update) {
  const Matrix6d J_base_imu = base_error_by_imu();
  const Se3 T_odom_base = state_.T_odom_imu * config_.T_base_imu.inverse();
  Eigen::Matrix<double, inertial::kFilterStates, 6> P_pose;  // of all states with the pose of the imu
  P_pose << P_.middleCols<6>(kPosition), wheels_.cross().head<6>().transpose();
  if (update.enough) {
    P_pose = with_true_noise(P_pose, config_.update.information_share * update.information);
  }
  const Se3 T_last_base = motion_.T_odom_base.inverse() * T_odom_base;
  motion_.drift_base.setZero();
  motion_.blind_odom.setZero();
  if (update.enough && confirmed_) {
    motion_.drift_base = map_drift(update.information, T_odom_base, J_base_imu, T_last_base, median_range_m);
    motion_.blind_odom = blind_way(update.localisability.weak,
                                   T_odom_base.translation() - motion_.T_odom_base.translation(), blind_share(update));
  }
  if (map_restarts_ != said_restarts_) {
    said_restarts_ = map_restarts_;  // the new map stands where the pose was believed to be
    motion_.drift_base += in_base_axes(J_base_imu * P_pose.topRows<6>() * J_base_imu.transpose(), T_odom_base);
  }
  motion_.transition = wheels_.transition();
  motion_.P_filter_base = P_pose * J_base_imu.transpose();
  motion_.J_base_imu = J_base_imu;
  drift_.add(motion_.T_odom_base, T_odom_base, motion_.drift_base, motion_.blind_odom);
  motion_.T_odom_base = T_odom_base;
  shared_errors_ = drift_.covariance() + errors_of_all_points();
}

// Along a weak direction the map was laid as the wheels had it, and so confirms their scale, however wrong: what counts
// is what was known of it when last all directions were seen.
double Odometry::blind_share(const UpdateResult& update) {
  if (wheels_.counts().used == 0) {
    return kBlindShare;
  }
  if (update.localisability.weak.count == 0 || seen_scale_std_ == 0.0) {
    seen_scale_std_ = wheels_.scale_std();
  }
  return std::max(kLeastScaleStd, seen_scale_std_);
}

State Odometry::next_state(Cause cause) {
  const bool bad = cause == Cause::kFewConstraints || cause == Cause::kFewInliers || cause == Cause::kLargeInnovation;
  bad_scans_ = bad ? bad_scans_ + 1 : 0;
  if (is_lost()) {
    return State::kLost;
  }
  return cause == Cause::kNone ? State::kTracking : State::kDegraded;
}

// Lost is also who no longer knows within a recovery swarm's reach where he is, and whom no scan has told since.
bool Odometry::is_lost() const {
  const auto std_of = [&](int block) { return std::sqrt(P_.diagonal().segment<3>(block).maxCoeff()); };
  const bool knows = std_of(kPosition) <= config_.lost_position_std_m && std_of(kRotation) <= config_.lost_rotation_std_rad;
  return bad_scans_ > config_.lost_after || unconfirmed_scans_ > config_.lost_unconfirmed_after ||
         (!knows && (between_scans_ || !confirmed_));
}

}  // namespace slamd::odometry
