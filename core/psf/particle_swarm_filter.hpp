#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/map/voxel_map.hpp"
#include "core/psf/likelihood.hpp"
#include "core/psf/swarm.hpp"
#include "core/registration/constraint.hpp"
#include "core/registration/gauss_newton.hpp"

namespace slamd::psf {

/// Sizes and thresholds of the filter (design.md, "Odometry").
struct PsfConfig {
  SwarmConfig swarm;
  std::size_t points = 200;             // M, of the likelihood
  std::size_t little_particles = 32;
  std::size_t recovery_particles = 128;  // doubles to max_particles while unsuccessful
  std::size_t max_particles = 256;
  double little_indoor_m = 0.01;         // side of the little square [Liu22]
  double little_indoor_rad = 0.1 * M_PI / 180.0;
  double little_outdoor_m = 0.10;
  double little_outdoor_rad = 0.5 * M_PI / 180.0;
  double recovery_m = 1.0;               // half box of the recovery swarm; doubles once while unsuccessful
  double recovery_rad = 10.0 * M_PI / 180.0;
  double max_recovery_m = 2.0;
  double max_recovery_rad = 20.0 * M_PI / 180.0;
  double sigma_first_m = 0.40;           // annealing of the likelihood
  double sigma_last_m = 0.06;
  double gate_sigma_m = 0.10;
  double gate_gain = 60.0;               // score = gain · ℓ + log prior
  double gate_margin = 2.0;              // what a mode must beat the plain update by
  double min_shared_points = 0.2;        // of all: fewer points that two poses both explain cannot decide between them
  double wide_penalty = 8.0;             // log odds against "the prediction was wrong"
  double mode_separation_boxes = 0.3;
  double same_mode_m = 0.05;             // nearer to the plain update than both of these
  double same_mode_rad = 0.5 * M_PI / 180.0;
  double trigger_drop = 0.35;            // of the mean log-likelihood below its running mean
};

/// Tells whether two poses are so near to one another that an update ends at the same one from both.
bool is_same_mode(const geometry::Se3& a, const geometry::Se3& b, const PsfConfig& config);

/// What the filter is asked: is the plain update's pose the right one?
struct Question {
  geometry::Se3 T_odom_imu_prior;
  geometry::Matrix6d P_prior = geometry::Matrix6d::Identity();  // of (δp, δθ)
  geometry::Se3 T_odom_imu_plain;  // what the iterated EKF found
  bool indoor = false;
  bool distrust_prior = false;     // recovery: an IMU gap, few inliers, or an innovation out of bounds
  std::uint64_t scan_index = 0;
};

/// What it answers.
struct Answer {
  geometry::Se3 T_odom_imu;       // the mode to linearise at
  bool swarm_won = false;         // it is not the plain update's
  bool recovery = false;          // the recovery swarm ran
  float log_likelihood = 0.0F;    // ℓ at gate_sigma_m, of the answer
  float plain_log_likelihood = 0.0F;
  std::uint32_t particles = 0;
  std::uint32_t modes = 0;
  double spread_m = 0.0;          // of the particles' memories, one standard deviation
};

/// The adapted particle swarm filter of [Liu22]: proposes modes of the pose; the posterior stays the EKF's, so that
/// nothing is counted twice.
/// Source: [Liu22]; deviations and their measurements: design.md, "Odometry: the adapted particle swarm filter".
/// Real-time: allocates in the constructor only; odometry thread only.
class ParticleSwarmFilter {
 public:
  ParticleSwarmFilter(const PsfConfig& config, std::uint64_t seed);

  /// Answers with the best mode of the scan's likelihood around the prediction.
  /// Frames: points in imu at the scan's end; poses T_odom_imu.
  Answer answer(std::span<const Eigen::Vector3f> points_imu, const map::VoxelMap& map, const Question& question);

  /// Forgets the running mean and the recovery's growth, as after a restart.
  void reset();

 private:
  bool is_recovery(const Question& question, float plain_log_likelihood) const;
  geometry::Vector6d half_box(const Question& question, bool recovery) const;
  void run_swarm(const map::VoxelMap& map, const Question& question, bool recovery, Random& random);
  bool fits_better_where_both_are_known(const map::VoxelMap& map, const Question& question,
                                        const geometry::Se3& T_odom_imu) const;
  double log_prior(const Question& question, const geometry::Se3& T_odom_imu) const;
  void remember(const Answer& answer);

  PsfConfig config_;
  std::uint64_t seed_;
  double running_log_likelihood_ = 0.0;
  bool has_running_ = false;
  double growth_ = 1.0;  // of the recovery box and swarm, while unsuccessful
  // scratch, sized once
  ScanLikelihood likelihood_;
  Swarm swarm_;
  BoundedVector<registration::Constraint> constraints_;
};

}  // namespace slamd::psf
