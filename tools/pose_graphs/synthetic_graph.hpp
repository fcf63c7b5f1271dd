#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/graph/back_end.hpp"

namespace slamd::pose_graphs {

/// How a synthetic vehicle drives.
enum class Course : std::uint8_t {
  kGrid,    // streets of a town: a walk over crossings, turned by 90°
  kSphere,  // rings on a sphere, one above the other, as the pose-graph literature has it
  kTown,    // rounds of blocks, each round several times, reverse now and then
};

/// What is wrong with the measurements. Units: 1σ, of one keyframe's step or of one loop.
struct Errors {
  double step_m = 0.01;           // over 1 m
  double step_tilt_rad = 0.0002;  // gravity holds roll and pitch
  double step_yaw_rad = 0.0005;
  double loop_m = 0.05;
  double loop_rad = 0.005;
  double gravity_rad = 0.005;
  double gnss_m = 2.0;           // horizontally; twice that vertically
};

/// What to make.
struct SyntheticConfig {
  Course course = Course::kGrid;
  std::size_t keyframes = 1'000;
  std::size_t loops = 300;            // true ones, at most: as many as there are revisits
  double false_share = 0.0;           // of all loops
  double false_runs = 0.0;            // of the false ones, come in runs of 3 to 5 that agree with each other
  double false_near = 0.0;            // of the false ones, join places within 15 m that look alike, 3 to 8 m off: racks, pillars
  bool gnss = false;
  double gnss_outage_s = 0.0;         // without a fix, at 1 m/s, at the middle of the way
  double gnss_jump_m = 0.0;           // of the fixes in three stretches of 30 s
  Errors errors;
  std::uint64_t seed = 1;
};

/// A loop with what it really is.
struct SyntheticLoop {
  graph::LoopCandidate candidate;
  bool is_true = true;
};

/// A drive: truth, and what the back end is told in the order of keyframes.
struct SyntheticGraph {
  std::vector<geometry::Se3> T_world_base;                // truth; the first is the identity
  std::vector<geometry::Se3> T_odom_base;
  std::vector<geometry::Matrix6d> motion_covariance;      // of the step to each keyframe
  std::vector<graph::GravityFactor> gravity;
  std::vector<std::optional<graph::GnssFactor>> fixes;
  graph::GnssAlignment T_world_enu;                       // truth
  std::vector<SyntheticLoop> loops;                       // in the order of their second keyframe
};

SyntheticGraph make_graph(const SyntheticConfig& config);

/// Returns the root of the mean squared distance between estimated and true positions, both from the first keyframe on.
/// Units: m.
double position_error(const SyntheticGraph& truth, const graph::PoseGraph& estimate);

/// The greatest and mean distance between true and estimated positions in the receiver's axes. Units: m.
struct EarthError {
  double rms_m = 0.0;
  double max_m = 0.0;
};
EarthError earth_error(const SyntheticGraph& truth, const graph::PoseGraph& estimate);

/// Fills a pose graph with everything at once, false loops and all, weights one, at the odometry's poses.
void fill(const SyntheticGraph& from, graph::PoseGraph& graph, bool with_gnss);

}  // namespace slamd::pose_graphs
