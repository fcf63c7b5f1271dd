#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/bounded_vector.hpp"
#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/back_end.hpp"
#include "core/loop/verification.hpp"
#include "core/mapping/appearance.hpp"
#include "core/mapping/cloud_builder.hpp"
#include "core/mapping/corrections.hpp"
#include "core/mapping/graph_uncertainty.hpp"
#include "core/mapping/keyframe_store.hpp"
#include "core/mapping/novelty.hpp"
#include "core/mapping/proximity.hpp"
#include "core/mapping/submaps.hpp"
#include "core/odometry/motion_covariance.hpp"

namespace slamd::mapping {

struct MapperConfig {
  std::size_t keyframes = 10'000;
  std::size_t loops = 4'096;
  std::size_t points_a_cloud = 4'096;
  std::size_t scans_a_cloud = 10;       // a keyframe's own and those right behind it
  std::size_t gathered_points = 60'000;  // of these scans, before they are thinned
  float cloud_spacing_indoor_m = 0.15F;
  float cloud_spacing_outdoor_m = 0.30F;
  double submap_m = 20.0;               // of the way in one submap
  // loops
  double neighbours_m = 6.0;            // of the way to each side of a candidate: keyframes that join its submap
  std::size_t neighbours = 4;           // at most, to each side
  double quiet_m = 10.0;                // of the way after a loop, unless the place has become uncertain again:
  double certain_std_m = 0.05;
  bool use_gravity = true;              // false without an inertial sensor: nothing says where up is
  double gravity_caution = 3.0;         // times the filter's standard deviation of the vertical, whose errors last:
  double least_gravity_std_rad = 0.003;  // a keyframe tells hardly more than the one before
  std::size_t kept_at_limit = 100;      // the newest keyframes are not taken out
  NoveltyConfig novelty;
  ProximityConfig proximity;
  bool use_loop_net = true;
  AppearanceConfig appearance;
  loop::VerificationConfig verification;
  graph::BackEndConfig back_end;        // its capacity follows from the above
};

/// What the mapper takes of a scan.
/// Frames: points in imu at `stamp`, the scan's end; up in odom.
struct MappedScan {
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  geometry::Se3 T_odom_imu;
  Eigen::Vector3d up_odom = Eigen::Vector3d::UnitZ();
  double up_std_rad = 0.0;
  bool indoor = false;
  bool trusted = false;        // the odometry extended its map by it
  bool after_gap = false;      // scans before it were lost: what the motion's covariance lacks is made up for
  odometry::MotionStep motion;  // since the scan before
  std::span<const Eigen::Vector3f> points_imu;  // may be left out: the cloud has less then
};

/// What became of a proposed loop.
struct LoopTrial {
  graph::KeyframeId candidate = 0;
  graph::KeyframeId query = 0;
  Stamp candidate_stamp{};
  Stamp query_stamp{};
  loop::LoopProposal proposal;
  loop::Verification verification;
  graph::Proposal graph_says = graph::Proposal::kNoKeyframe;  // where it was verified
  graph::LoopId loop = 0;  // likewise
};

inline constexpr std::size_t kGraphProposals = 5;
inline constexpr std::size_t kLoopVerdicts = 5;

/// What has become of all proposals so far.
struct LoopCounts {
  std::uint64_t candidates = 0;  // that were registered
  std::array<std::uint64_t, loop::kVerdicts> verdicts{};       // by loop::Verdict
  std::array<std::uint64_t, kGraphProposals> proposed{};       // of the verified ones, by graph::Proposal
  std::array<std::uint64_t, kLoopVerdicts> graph_verdicts{};   // by graph::LoopVerdict

  std::uint64_t verified() const { return verdicts[static_cast<std::size_t>(loop::Verdict::kVerified)]; }
  std::uint64_t accepted() const { return graph_verdicts[static_cast<std::size_t>(graph::LoopVerdict::kAccepted)]; }
  std::uint64_t removed() const {
    return graph_verdicts[static_cast<std::size_t>(graph::LoopVerdict::kTakenOut)] -
           graph_verdicts[static_cast<std::size_t>(graph::LoopVerdict::kTakenBack)];
  }
};

/// What a scan has changed. Spans are valid until the next call.
struct MapperUpdate {
  bool keyframe_added = false;
  std::optional<graph::KeyframeId> retired;  // to make room for it
  std::span<const LoopTrial> trials;
  std::span<const graph::LoopEvent> loops;
  bool corrected = false;  // poses of keyframes have moved: correction_id, T_map_odom and submaps are new
};

/// The map that corrects itself: keyframes where the way is new, loops where it comes back, and the graph of both.
///
/// process() takes every scan after the odometry. A keyframe's cloud is gathered from its scan and those right behind it; when
/// it is whole the keyframe enters the graph, with the odometry's covariance of the motion from the one before, loops are
/// proposed and verified against the submap around each candidate, and the back end decides which are believed.
/// At the limit of keyframes the most redundant one is retired: its cloud is forgotten, its loops hang on its neighbours.
/// Never touches odom: what it gives is where odom lies in map.
/// Memory: sized once, but for what graph::NormalEquations says, and path().  Mapping thread only.
class Mapper {
 public:
  explicit Mapper(const MapperConfig& config);

  /// Takes a scan in.
  MapperUpdate process(const MappedScan& scan);

  /// Closes the keyframe that is being gathered: at the end of a recording.
  MapperUpdate finish();

  /// Forgets everything, for an odom that has begun anew. correction_id goes on: one more if there was any.
  void restart();

  const KeyframeStore& keyframes() const { return keyframes_; }
  const graph::PoseGraph& graph() const { return back_end_->graph(); }
  const geometry::Se3& T_map_base(std::size_t keyframe) const { return back_end_->graph().node(keyframe).T_map_base; }
  const Submaps& submaps() const { return submaps_; }
  const geometry::Se3& T_map_odom() const { return T_map_odom_; }

  /// +1 with each correction; 0: map is odom.
  std::uint32_t correction_id() const { return correction_id_; }

  const LoopCounts& counts() const { return counts_; }
  std::uint64_t retired() const { return retired_; }

  /// Returns all keyframes with their corrected poses.
  std::vector<CorrectedKeyframe> path() const;

 private:
  void follow(const MappedScan& scan);
  void begin_keyframe(const MappedScan& scan);
  void gather(const MappedScan& scan);
  MapperUpdate close_keyframe();
  std::optional<graph::KeyframeId> make_room();
  void propose();
  void try_loop(const loop::LoopProposal& proposal);
  void gather_submap(std::size_t candidate);
  bool correct(const graph::Update& update);
  geometry::Se3 T_map_odom_at(graph::KeyframeId id) const;

  MapperConfig config_;
  std::optional<graph::BackEnd> back_end_;
  KeyframeStore keyframes_;
  GraphUncertainty uncertainty_;
  std::optional<Appearance> appearance_;
  Submaps submaps_;
  CloudBuilder cloud_;
  loop::LoopVerifier verifier_;

  // the way
  double path_m_ = 0.0;
  bool any_scan_ = false;
  geometry::Se3 T_odom_last_;
  std::optional<odometry::MotionCovariance> since_keyframe_;
  bool has_gap_ = false;  // since the newest keyframe
  graph::KeyframeId next_id_ = 0;

  // the keyframe that is being gathered
  struct Open {
    Keyframe keyframe;
    geometry::Matrix6d motion_covariance = geometry::Matrix6d::Zero();
    Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();
    double up_std_rad = 0.0;
    std::size_t scans = 0;
    bool indoor = false;
  };
  std::optional<Open> open_;
  geometry::Se3 T_odom_newest_;  // the newest keyframe's, gathered or being so

  geometry::Se3 T_map_odom_;
  std::uint32_t correction_id_ = 0;
  std::optional<double> last_loop_path_m_;
  LoopCounts counts_;
  std::uint64_t retired_ = 0;

  // scratch, sized once
  std::optional<graph::KeyframeId> submap_of_;  // what the verifier holds
  BoundedVector<Eigen::Vector3f> submap_points_;
  BoundedVector<Eigen::Vector3f> query_points_;
  BoundedVector<loop::LoopProposal> proposals_;
  BoundedVector<LoopTrial> trials_;
};

}  // namespace slamd::mapping
