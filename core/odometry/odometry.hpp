#pragma once

#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/calibration/gravity_check.hpp"
#include "core/calibration/lidar_imu_check.hpp"
#include "core/odometry/environment.hpp"
#include "core/odometry/iterated_update.hpp"
#include "core/odometry/localisability.hpp"
#include "core/odometry/map_drift.hpp"
#include "core/odometry/motion_covariance.hpp"
#include "core/odometry/odometry_config.hpp"
#include "core/odometry/state.hpp"
#include "core/odometry/weak_memory.hpp"
#include "core/psf/particle_swarm_filter.hpp"

namespace slamd::odometry {

/// The pose after a scan.
/// Frames: pose and velocity of base in odom; covariance of (δp, δθ) of T_odom_base.  Units: m, rad, m/s.
struct OdometryResult {
  std::uint64_t scan_index = 0;
  Stamp stamp{};
  State state = State::kStarting;
  Cause cause = Cause::kAligning;
  geometry::Se3 T_odom_base;
  geometry::Se3 T_odom_imu;
  Eigen::Vector3d v_odom_base = Eigen::Vector3d::Zero();
  geometry::Matrix6d P_odom_base = geometry::Matrix6d::Identity();  // against what lies around: see SurroundingsDrift
  Eigen::Vector3d up_odom = Eigen::Vector3d::UnitZ();  // the vertical as estimated: odom leans by its angle to z
  double up_std_rad = 0.0;
  std::uint8_t weak_axes = 0;  // bits 0..2: x, y, z of odom; 3..5: turns about them
  std::uint8_t weak_axes_base = 0;  // the same, of base
  Localisability localisability;
  bool indoor = false;
  bool map_updated = false;
  std::uint32_t map_restarts = 0;  // how often the old map was not found again
  psf::Answer swarm;
  UpdateResult update;
};

/// The odometry: inertial prediction, iterated EKF, particle swarm filter and local map, a scan at a time.
/// Real-time: allocates in the constructor only; odometry thread only.
class Odometry {
 public:
  explicit Odometry(const OdometryConfig& config);
  virtual ~Odometry() = default;

  /// Sets the first state; scans before it are not to be given. Called again it forgets the map and all else, and odom
  /// begins anew. Real-time: O(capacity of the map).
  void start(const inertial::Alignment& alignment);

  /// Starts where there is no inertial sensor: odom is base at `stamp`.
  void start_without_imu(Stamp stamp);

  bool started() const { return started_; }

  /// Takes a deskewed scan in and returns the pose at its end.
  /// `samples` bracket the time since the last scan; empty: constant velocity. `wheels` are those since the last scan.
  OdometryResult process(const scan::DeskewedScan& scan,
                         std::span<const sensor::ImuSample> samples,
                         std::span<const sensor::WheelSample> wheels = {});

  /// Goes on to `to` without a scan, where none has come for a while: from the inertial sensor and the wheels, and held
  /// where these say that the vehicle stands. Of the result only stamp, state, cause, poses, velocity, the vertical and
  /// P_odom_base are set. DEGRADED, and LOST once the covariance is beyond what a recovery swarm searches.
  /// Real-time: no allocation; O(samples · 17³).
  OdometryResult go_on_without_scan(Stamp to, std::span<const sensor::ImuSample> samples,
                                    std::span<const sensor::WheelSample> wheels = {});

  /// What the last scan adds to the covariance of motions: see MotionCovariance.
  const MotionStep& motion() const { return motion_; }

  /// What the covariance of the pose has beside the filter's own: errors that all points share, and the map's drift.
  const geometry::Matrix6d& shared_errors() const { return shared_errors_; }

  const inertial::NavState& state() const { return state_; }
  const inertial::Covariance& covariance() const { return P_; }
  const map::VoxelMap& map() const { return map_; }
  const inertial::WheelUpdate& wheels() const { return wheels_; }

  /// What the drive has shown of the sensors' places and clocks; nothing of the odometry depends on it.
  /// Real-time: no allocation; some 20 µs.
  calibration::SensorAgreement agreement() const { return {lidar_imu_check_.agreement(), gravity_check_.agreement()}; }

  bool indoor() const { return environment_.indoor(); }

 protected:
  /// Finds the posterior of a scan from the prediction in state() and covariance(). Studies put other estimators here,
  /// so that all else is the product's.
  virtual UpdateResult update(const scan::DeskewedScan& scan, Cause prediction_cause, psf::Answer& swarm);

  // What studies disturb and put back.
  void go_on_from(const inertial::NavState& state, const inertial::Covariance& P) { state_ = state, P_ = P; }
  psf::ParticleSwarmFilter& filter() { return psf_; }

 private:
  void begin();
  Cause predict(Stamp to, std::span<const sensor::ImuSample> samples, std::span<const sensor::WheelSample> wheels);
  void propagate(Stamp to, std::span<const sensor::ImuSample> samples);
  bool pass_unseen(Stamp to, std::span<const sensor::ImuSample> samples, std::span<const sensor::WheelSample> wheels);
  void hold_at_rest(std::span<const sensor::ImuSample> samples, std::span<const sensor::WheelSample> wheels);
  void check_lidar_imu(const inertial::NavState& before, bool by_imu, const UpdateResult& posterior);
  void coast(bool without_imu);
  bool is_jump(const geometry::Se3& T_odom_imu_predicted, const geometry::Se3& T_odom_imu) const;
  bool lost_the_thread(const scan::DeskewedScan& scan, Cause prediction_cause) const;
  Cause confirm(const UpdateResult& update, Cause update_cause);
  Cause contradiction_of(const UpdateResult& update) const;
  Cause judge(const UpdateResult& update) const;
  void extend_map(const scan::DeskewedScan& scan);
  geometry::Matrix6d base_error_by_imu() const;
  OdometryResult pose_result(Stamp stamp) const;
  OdometryResult result_of(const scan::DeskewedScan& scan, Cause cause, const UpdateResult& update);
  void note_uncertainty(double median_range_m, const UpdateResult& update);
  double blind_share(const UpdateResult& update);
  State next_state(Cause cause);
  bool is_lost() const;
  std::span<const Eigen::Vector3f> swarm_points(const scan::DeskewedScan& scan);

  OdometryConfig config_;
  map::VoxelMap map_;
  psf::ParticleSwarmFilter psf_;
  EnvironmentEstimate environment_;
  bool started_ = false;
  inertial::NavState state_;
  inertial::Covariance P_ = inertial::Covariance::Identity();
  inertial::WheelUpdate wheels_;
  inertial::ZeroVelocityUpdate zero_velocity_;
  bool between_scans_ = false;  // the last step was without a scan: the transition still counts from the last scan on
  Eigen::Vector3d rate_imu_radps_ = Eigen::Vector3d::Zero();  // at the last scan's end
  bool coasting_ = false;  // the inertial sensor is configured, but silent
  Eigen::Vector3d waiting_gyro_bias_ = Eigen::Vector3d::Zero();
  double path_m_ = 0.0;
  calibration::LidarImuCheck lidar_imu_check_;
  calibration::GravityCheck gravity_check_;
  int bad_scans_ = 0;
  // Whether the pose hangs together with the map: not after a gap, until the map has agreed a few times.
  bool confirmed_ = true;
  bool was_weak_ = false;           // when it last did
  WeakMemory weak_memory_;
  int agreeing_scans_ = 0;
  int unconfirmed_scans_ = 0;
  int unmet_scans_ = 0;             // of these: in a row with little of the old map
  int restart_said_ = 0;            // scans for which the map's restart is still said
  std::uint32_t map_restarts_ = 0;
  Stamp last_scan_end_{};
  Stamp last_corrected_{};          // by a scan
  MotionStep motion_;
  SurroundingsDrift drift_;
  double seen_scale_std_ = 0.0;  // of the wheels, when last all directions were seen; 0: not yet
  std::uint32_t said_restarts_ = 0;
  geometry::Matrix6d shared_errors_ = geometry::Matrix6d::Zero();
  // scratch, sized once
  registration::Association association_;
  BoundedVector<Eigen::Vector3f> points_odom_;
  BoundedVector<Eigen::Vector3f> swarm_points_imu_;
};

}  // namespace slamd::odometry
