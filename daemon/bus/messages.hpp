#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/fixed_vector.hpp"
#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"
#include "daemon/bus/text.hpp"

// What the bus carries, as plain structs; docs/protocol.md has the messages themselves. Only Command and Reply own
// memory; Health is trivially copyable, so that it passes through Latest.
namespace slamd::bus {

/// No message is larger, so that it fits a frame of Ethernet with the headers of IP, UDP and LCM. Units: bytes.
inline constexpr std::size_t kLargestMessage_bytes = 1400;

/// How much of the pose to believe (design.md, "States"). The first four count as odometry::State does.
enum class State : std::uint8_t { kStarting, kTracking, kDegraded, kLost, kRelocalising };

/// Why it is not better. Counts as odometry::Cause does.
enum class Cause : std::uint8_t {
  kNone,
  kAligning,
  kNoImu,
  kImuGap,
  kFewConstraints,
  kFewInliers,
  kLargeInnovation,
  kDegenerate,
  kSaturated,
  kUnconfirmed,
  kMapRestarted,
  kNoLidar,
};

/// The names that people and --json see: "TRACKING"; "few inliers".
const char* name_of(State state);
const char* name_of(Cause cause);

/// Where the robot is, at every sample of the inertial sensor.
/// Frames: T_odom_base; velocity of base in odom; angular rate in base.  Units: m, m/s, rad/s.
struct Pose {
  Stamp stamp{};   // of the inertial sample
  Duration age{};  // from stamp to sending
  geometry::Se3 T_odom_base;
  Eigen::Vector3d v_odom_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_base_radps = Eigen::Vector3d::Zero();
  geometry::Matrix6d P_odom_base = geometry::Matrix6d::Zero();     // of (δp, δθ): odom axes, then base axes
  Eigen::Matrix3d P_velocity_odom = Eigen::Matrix3d::Zero();
  std::uint32_t reset_counter = 0;  // +1 with each jump of the pose that is larger than its uncertainty
  std::uint32_t correction_id = 0;  // the newest MapToOdom that was sent
  State state = State::kStarting;
  Cause cause = Cause::kAligning;
  std::uint8_t weak_axes = 0;  // bits 0..2: x, y, z of odom; 3..5: turns about them
};

/// What moved map against odom last.
enum class Correction : std::uint8_t { kStart, kLoop, kGnss, kRelocalisation, kCommand };

const char* name_of(Correction cause);

/// Where odom lies in map: on change and once a second. Poses themselves never jump because of it.
struct MapToOdom {
  Stamp stamp{};
  geometry::Se3 T_map_odom;
  std::uint32_t correction_id = 0;  // +1 with each change
  Correction cause = Correction::kStart;
};

/// Where a submap lies in map. What a client holds of it stays where it is in the submap.
/// Frames: T_odom_submap is the anchor's translation, for life.
struct SubmapPose {
  std::uint32_t id = 0;
  std::uint32_t version = 0;  // +1 with each change of T_map_submap
  Eigen::Vector3d anchor_odom = Eigen::Vector3d::Zero();
  geometry::Se3 T_map_submap;
};

/// A message of SubmapPoses: after each correction and once a second.
struct SubmapPoses {
  static constexpr std::size_t kSubmaps = 18;

  Stamp stamp{};                    // of sending
  std::uint32_t correction_id = 0;  // as in MapToOdom
  std::uint32_t epoch = 0;          // of odom
  std::uint16_t index = 0;          // of this chunk
  std::uint16_t count = 1;          // of chunks; all but the last are full
  std::array<SubmapPose, kSubmaps> submaps;
  std::size_t size = 0;  // of these: in this chunk
};

/// A deskewed scan, as the odometry has it after its update. The points are read before publish() returns.
/// Frames: points_imu as seen from imu at stamp, the scan's end.  Units: m.
struct Scan {
  std::uint64_t scan_index = 0;
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  geometry::Se3 T_odom_imu;
  std::span<const Eigen::Vector3f> points_imu;
};

/// A sensor as health tells it.
enum class SensorState : std::uint8_t { kNotConfigured, kWaiting, kRunning, kSilent, kFaulty };
enum class TimeState : std::uint8_t { kUnknown, kAcquiring, kLocked, kShared, kStepped };

const char* name_of(SensorState state);
const char* name_of(TimeState state);

struct SensorHealth {
  Text<15> name;  // "vlp16", "imu"
  SensorState state = SensorState::kWaiting;
  TimeState time = TimeState::kUnknown;
  float rate_hz = 0.0F;           // of scans or samples, over the last seconds
  std::uint64_t received = 0;     // packets or samples
  std::uint64_t lost = 0;         // that the sensor sent (gaps of counters or stamps)
  std::uint64_t dropped = 0;      // that came and could not be used: malformed, full pool, foreign source
  float time_residual_us = 0.0F;  // mean of arrival - mapped stamp
  float time_skew_ppm = 0.0F;     // of the device's clock
  std::uint32_t time_steps = 0;
};

/// What one thread's work took, over the last seconds.
struct StageHealth {
  Text<15> name;
  float p50_us = 0.0F;
  float p99_us = 0.0F;
  float max_us = 0.0F;
  std::uint32_t count = 0;
};

struct PoolHealth {
  Text<15> name;
  std::uint32_t capacity = 0;
  std::uint32_t low_water = 0;  // the fewest that were ever free
};

struct CounterHealth {
  Text<19> name;
  std::uint64_t value = 0;
};

/// How the daemon is, twice a second. Always fits one message: what does not fit a list is not sent, so that the
/// important comes first; try_push_back says so.
struct Health {
  Stamp stamp{};
  Duration uptime{};
  State state = State::kStarting;
  std::uint8_t weak_axes = 0;  // as in Pose
  FixedVector<Text<79>, 3> causes;  // in words, the most important first: "imu: silent for 1.2 s"
  FixedVector<SensorHealth, 4> sensors;
  FixedVector<StageHealth, 8> stages;
  FixedVector<PoolHealth, 6> pools;
  FixedVector<CounterHealth, 12> counters;
  float swarm_use = 0.0F;         // share of scans whose swarm moved the pose
  std::uint32_t particles = 0;    // of the last swarm
  float inlier_share = 0.0F;      // of the last scan's constraints
  float imu_offset_ms = 0.0F;     // by which inertial stamps are late against the LiDAR's
  float imu_offset_std_ms = 0.0F;  // of it; 0: not known
};
static_assert(std::is_trivially_copyable_v<Health>);

/// An order to the daemon.
struct Command {
  static constexpr std::size_t kMaxArguments = 4;
  static constexpr std::size_t kMaxArgument_bytes = 255;

  std::uint64_t id = 0;  // chosen by the client at random, kept when it repeats itself
  std::string verb;      // one of kVerbs
  std::vector<std::string> arguments;
};

/// The verbs and what they take.
struct Verb {
  std::string_view name;
  std::size_t arguments = 0;
};
inline constexpr std::array<Verb, 4> kVerbs{{{"new-map", 0}, {"save", 1}, {"set-pose", 4}, {"seal", 0}}};

/// Says what is wrong with a command, in words; empty: nothing.
/// set-pose takes x, y, z (m) and yaw (degrees) of base in map, finite numbers; save takes a plain name.
std::string fault_of(const Command& command);

/// The answer to a command of the same id.
struct Reply {
  std::uint64_t id = 0;
  bool ok = false;
  std::string text;  // for people; up to 1,000 bytes are sent
};

/// How a vehicle shall move, from a planner or a person. Holds for kCommandHolds.
/// Units: m/s ahead, rad/s to the left.
struct VelocityCommand {
  Stamp stamp{};
  double v_mps = 0.0;
  double w_radps = 0.0;
};

/// A vehicle that hears nothing for longer stops.
inline constexpr Duration kCommandHolds = std::chrono::milliseconds(500);

/// Where a simulated vehicle really is.
/// Frames: T_world_base; velocity of base in world; angular rate in base.
struct Truth {
  Stamp stamp{};
  geometry::Se3 T_world_base;
  Eigen::Vector3d v_world_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_base_radps = Eigen::Vector3d::Zero();
  std::uint32_t collisions = 0;
};

}  // namespace slamd::bus
