#include "daemon/bus/encoding.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <slamd_lcm/command_t.hpp>
#include <slamd_lcm/health_t.hpp>
#include <slamd_lcm/map_to_odom_t.hpp>
#include <slamd_lcm/pose_t.hpp>
#include <slamd_lcm/reply_t.hpp>
#include <slamd_lcm/scan_chunk_t.hpp>
#include <slamd_lcm/submap_poses_t.hpp>
#include <slamd_lcm/truth_t.hpp>
#include <slamd_lcm/velocity_command_t.hpp>

#include "core/base/bytes.hpp"
#include "daemon/bus/raw_message.hpp"

namespace slamd::bus {

namespace {

constexpr std::size_t kFingerprint_bytes = 8;
constexpr std::size_t kLongestReply_bytes = 1000;

/// Walks over the fields of a message to see that the strings stay inside it: lcm-gen 1.3.1's decoders trust a string's
/// length below one, and would throw or overflow.
class Walk {
 public:
  /// LCM 1.3.1 gives a datagram whose channel name has no end a size below zero, which is some 4 GB here: what is larger
  /// than a message may be is not looked into.
  explicit Walk(std::span<const std::byte> message) : message_(message), inside_(message.size() <= kLargestMessage_bytes) {
    skip(kFingerprint_bytes);
  }

  void skip(std::size_t bytes) {
    inside_ = inside_ && bytes <= message_.size() - at_;
    at_ += inside_ ? bytes : 0;
  }

  void skip_string() {
    const std::size_t begin = at_;
    skip(sizeof(std::int32_t));
    if (!inside_) {
      return;
    }
    const auto length = load_be<std::int32_t>(message_, begin);  // with the zero at its end
    if (length < 1) {
      inside_ = false;
      return;
    }
    skip(static_cast<std::size_t>(length));
    inside_ = inside_ && message_[at_ - 1] == std::byte{0};
  }

  bool ends_here() const { return inside_ && at_ == message_.size(); }

 private:
  std::span<const std::byte> message_;
  std::size_t at_ = 0;
  bool inside_;
};

void write_transform(const geometry::Se3& T, double (&position_m)[3], double (&quaternion_xyzw)[4]) {
  const Eigen::Quaterniond q = T.quaternion();
  Eigen::Vector3d::Map(position_m) = T.translation();
  Eigen::Vector4d::Map(quaternion_xyzw) = q.coeffs();
}

/// Nothing for what is no place and orientation.
std::optional<geometry::Se3> read_transform(const double (&position_m)[3], const double (&quaternion_xyzw)[4]) {
  const Eigen::Vector3d p = Eigen::Vector3d::Map(position_m);
  const Eigen::Vector4d q = Eigen::Vector4d::Map(quaternion_xyzw);
  if (!p.allFinite() || !q.allFinite() || std::abs(q.norm() - 1.0) > 1e-3) {
    return std::nullopt;
  }
  return geometry::Se3(Eigen::Quaterniond(q), p);
}

template <typename Matrix>
void write_triangle(const Matrix& P, float* values) {
  for (int row = 0; row < P.rows(); ++row) {
    for (int column = row; column < P.cols(); ++column) {
      *values++ = static_cast<float>(P(row, column));
    }
  }
}

template <typename Matrix>
void read_triangle(const float* values, Matrix& P) {
  for (int row = 0; row < P.rows(); ++row) {
    for (int column = row; column < P.cols(); ++column) {
      P(row, column) = P(column, row) = static_cast<double>(*values++);
    }
  }
}

/// Nothing for a number that has no name.
template <typename Enum>
std::optional<Enum> read_enum(std::uint8_t value, Enum last) {
  if (value > static_cast<std::uint8_t>(last)) {
    return std::nullopt;
  }
  return static_cast<Enum>(value);
}

std::int64_t ns_of(Stamp stamp) { return stamp.time_since_epoch().count(); }
Stamp stamp_of(std::int64_t ns) { return Stamp(Duration(ns)); }

}  // namespace

std::size_t encode(const Pose& pose, std::span<std::byte> buffer) {
  slamd_lcm::pose_t message;
  message.stamp_ns = ns_of(pose.stamp);
  message.age_ns = pose.age.count();
  write_transform(pose.T_odom_base, message.position_odom_m, message.quaternion_odom_base);
  Eigen::Vector3d::Map(message.velocity_odom_mps) = pose.v_odom_base;
  Eigen::Vector3d::Map(message.rate_base_radps) = pose.rate_base_radps;
  write_triangle(pose.P_odom_base, message.pose_covariance);
  write_triangle(pose.P_velocity_odom, message.velocity_covariance_odom);
  message.reset_counter = static_cast<std::int32_t>(pose.reset_counter);
  message.correction_id = static_cast<std::int32_t>(pose.correction_id);
  message.state = static_cast<std::uint8_t>(pose.state);
  message.cause = static_cast<std::uint8_t>(pose.cause);
  message.weak_axes = pose.weak_axes;
  return write_raw(message, buffer);
}

std::optional<Pose> decode_pose(std::span<const std::byte> bytes) {
  slamd_lcm::pose_t message;
  if (!read_raw(bytes, message)) {
    return std::nullopt;
  }
  const auto T_odom_base = read_transform(message.position_odom_m, message.quaternion_odom_base);
  const auto state = read_enum(message.state, State::kRelocalising);
  const auto cause = read_enum(message.cause, Cause::kNoLidar);
  if (!T_odom_base || !state || !cause) {
    return std::nullopt;
  }
  Pose pose;
  pose.stamp = stamp_of(message.stamp_ns);
  pose.age = Duration(message.age_ns);
  pose.T_odom_base = *T_odom_base;
  pose.v_odom_base = Eigen::Vector3d::Map(message.velocity_odom_mps);
  pose.rate_base_radps = Eigen::Vector3d::Map(message.rate_base_radps);
  read_triangle(message.pose_covariance, pose.P_odom_base);
  read_triangle(message.velocity_covariance_odom, pose.P_velocity_odom);
  pose.reset_counter = static_cast<std::uint32_t>(message.reset_counter);
  pose.correction_id = static_cast<std::uint32_t>(message.correction_id);
  pose.state = *state;
  pose.cause = *cause;
  pose.weak_axes = message.weak_axes;
  return pose;
}

std::size_t encode(const MapToOdom& map_to_odom, std::span<std::byte> buffer) {
  slamd_lcm::map_to_odom_t message;
  message.stamp_ns = ns_of(map_to_odom.stamp);
  write_transform(map_to_odom.T_map_odom, message.position_map_m, message.quaternion_map_odom);
  message.correction_id = static_cast<std::int32_t>(map_to_odom.correction_id);
  message.cause = static_cast<std::uint8_t>(map_to_odom.cause);
  return write_raw(message, buffer);
}

std::optional<MapToOdom> decode_map_to_odom(std::span<const std::byte> bytes) {
  slamd_lcm::map_to_odom_t message;
  if (!read_raw(bytes, message)) {
    return std::nullopt;
  }
  const auto T_map_odom = read_transform(message.position_map_m, message.quaternion_map_odom);
  const auto cause = read_enum(message.cause, Correction::kCommand);
  if (!T_map_odom || !cause) {
    return std::nullopt;
  }
  return MapToOdom{.stamp = stamp_of(message.stamp_ns),
                   .T_map_odom = *T_map_odom,
                   .correction_id = static_cast<std::uint32_t>(message.correction_id),
                   .cause = *cause};
}

std::size_t encode(const SubmapPoses& submap_poses, std::span<std::byte> buffer) {
  slamd_lcm::submap_poses_t message{};
  message.stamp_ns = ns_of(submap_poses.stamp);
  message.correction_id = static_cast<std::int32_t>(submap_poses.correction_id);
  message.epoch = static_cast<std::int32_t>(submap_poses.epoch);
  message.chunk_index = static_cast<std::int16_t>(submap_poses.index);
  message.chunk_count = static_cast<std::int16_t>(submap_poses.count);
  message.submap_count = static_cast<std::int16_t>(submap_poses.size);
  for (std::size_t i = 0; i < submap_poses.size; ++i) {
    const SubmapPose& submap = submap_poses.submaps[i];
    slamd_lcm::submap_pose_t& out = message.submaps[i];
    out.id = static_cast<std::int32_t>(submap.id);
    out.version = static_cast<std::int32_t>(submap.version);
    Eigen::Vector3d::Map(out.anchor_odom_m) = submap.anchor_odom;
    Eigen::Vector3d::Map(out.position_map_m) = submap.T_map_submap.translation();
    Eigen::Vector4f::Map(out.quaternion_map_submap) = submap.T_map_submap.quaternion().coeffs().cast<float>();
  }
  return write_raw(message, buffer);
}

std::optional<SubmapPoses> decode_submap_poses(std::span<const std::byte> bytes) {
  slamd_lcm::submap_poses_t message;
  if (!read_raw(bytes, message)) {
    return std::nullopt;
  }
  const auto full = static_cast<std::int16_t>(SubmapPoses::kSubmaps);
  const bool last = message.chunk_index == message.chunk_count - 1;
  if (message.chunk_index < 0 || message.chunk_index >= message.chunk_count || message.submap_count < 0 ||
      message.submap_count > full || (!last && message.submap_count != full)) {
    return std::nullopt;
  }
  SubmapPoses submap_poses{.stamp = stamp_of(message.stamp_ns),
                           .correction_id = static_cast<std::uint32_t>(message.correction_id),
                           .epoch = static_cast<std::uint32_t>(message.epoch),
                           .index = static_cast<std::uint16_t>(message.chunk_index),
                           .count = static_cast<std::uint16_t>(message.chunk_count),
                           .submaps = {},
                           .size = static_cast<std::size_t>(message.submap_count)};
  for (std::size_t i = 0; i < submap_poses.size; ++i) {
    const slamd_lcm::submap_pose_t& in = message.submaps[i];
    double quaternion_xyzw[4];
    std::copy(in.quaternion_map_submap, in.quaternion_map_submap + 4, quaternion_xyzw);
    const auto T_map_submap = read_transform(in.position_map_m, quaternion_xyzw);
    const Eigen::Vector3d anchor_odom = Eigen::Vector3d::Map(in.anchor_odom_m);
    if (!T_map_submap || !anchor_odom.allFinite()) {
      return std::nullopt;
    }
    submap_poses.submaps[i] = {static_cast<std::uint32_t>(in.id), static_cast<std::uint32_t>(in.version), anchor_odom,
                               *T_map_submap};
  }
  return submap_poses;
}

std::size_t encode(const ScanChunk& chunk, std::span<std::byte> buffer) {
  slamd_lcm::scan_chunk_t message;
  message.scan_index = static_cast<std::int64_t>(chunk.scan_index);
  message.stamp_ns = ns_of(chunk.stamp);
  message.chunk_index = static_cast<std::int16_t>(chunk.index);
  message.chunk_count = static_cast<std::int16_t>(chunk.count);
  message.scan_crc32 = static_cast<std::int32_t>(chunk.scan_crc32);
  write_transform(chunk.T_odom_base, message.position_odom_m, message.quaternion_odom_base);
  Eigen::Vector3d::Map(message.origin_odom_m) = chunk.origin_odom;
  message.point_count = static_cast<std::int16_t>(chunk.points_cm.size());
  for (std::size_t i = 0; i < ScanChunk::kPoints; ++i) {
    const ScanChunk::Point point = i < chunk.points_cm.size() ? chunk.points_cm[i] : ScanChunk::Point{};
    std::copy(point.begin(), point.end(), message.points_cm[i]);
  }
  return write_raw(message, buffer);
}

std::optional<ScanChunk> decode_scan_chunk(std::span<const std::byte> bytes) {
  slamd_lcm::scan_chunk_t message;
  if (!read_raw(bytes, message)) {
    return std::nullopt;
  }
  const auto T_odom_base = read_transform(message.position_odom_m, message.quaternion_odom_base);
  const Eigen::Vector3d origin_odom = Eigen::Vector3d::Map(message.origin_odom_m);
  const bool last = message.chunk_index == message.chunk_count - 1;
  const auto full = static_cast<std::int16_t>(ScanChunk::kPoints);
  if (!T_odom_base || !origin_odom.allFinite() || message.chunk_index < 0 ||
      message.chunk_index >= message.chunk_count ||
      message.chunk_count > static_cast<int>(ScanChunk::kMaxChunks) || message.point_count < 0 || message.point_count > full ||
      (!last && message.point_count != full)) {
    return std::nullopt;
  }
  ScanChunk chunk;
  chunk.scan_index = static_cast<std::uint64_t>(message.scan_index);
  chunk.stamp = stamp_of(message.stamp_ns);
  chunk.index = static_cast<std::uint16_t>(message.chunk_index);
  chunk.count = static_cast<std::uint16_t>(message.chunk_count);
  chunk.scan_crc32 = static_cast<std::uint32_t>(message.scan_crc32);
  chunk.T_odom_base = *T_odom_base;
  chunk.origin_odom = origin_odom;
  for (int i = 0; i < message.point_count; ++i) {
    chunk.points_cm.push_back({message.points_cm[i][0], message.points_cm[i][1], message.points_cm[i][2]});
  }
  return chunk;
}

namespace {

void write_sensor(const SensorHealth& sensor, slamd_lcm::sensor_health_t& message) {
  message.name = sensor.name.view();
  message.state = static_cast<std::uint8_t>(sensor.state);
  message.time_state = static_cast<std::uint8_t>(sensor.time);
  message.rate_hz = sensor.rate_hz;
  message.received = static_cast<std::int64_t>(sensor.received);
  message.lost = static_cast<std::int64_t>(sensor.lost);
  message.dropped = static_cast<std::int64_t>(sensor.dropped);
  message.time_residual_us = sensor.time_residual_us;
  message.time_skew_ppm = sensor.time_skew_ppm;
  message.time_steps = static_cast<std::int32_t>(sensor.time_steps);
}

std::optional<SensorHealth> read_sensor(const slamd_lcm::sensor_health_t& message) {
  const auto state = read_enum(message.state, SensorState::kFaulty);
  const auto time = read_enum(message.time_state, TimeState::kStepped);
  if (!state || !time) {
    return std::nullopt;
  }
  return SensorHealth{.name = std::string_view(message.name),
                      .state = *state,
                      .time = *time,
                      .rate_hz = message.rate_hz,
                      .received = static_cast<std::uint64_t>(message.received),
                      .lost = static_cast<std::uint64_t>(message.lost),
                      .dropped = static_cast<std::uint64_t>(message.dropped),
                      .time_residual_us = message.time_residual_us,
                      .time_skew_ppm = message.time_skew_ppm,
                      .time_steps = static_cast<std::uint32_t>(message.time_steps)};
}

void write_stage(const StageHealth& stage, slamd_lcm::stage_health_t& message) {
  message.name = stage.name.view();
  message.p50_us = stage.p50_us;
  message.p99_us = stage.p99_us;
  message.max_us = stage.max_us;
  message.count = static_cast<std::int32_t>(stage.count);
}

StageHealth read_stage(const slamd_lcm::stage_health_t& message) {
  return {.name = std::string_view(message.name),
          .p50_us = message.p50_us,
          .p99_us = message.p99_us,
          .max_us = message.max_us,
          .count = static_cast<std::uint32_t>(message.count)};
}

void write_pool(const PoolHealth& pool, slamd_lcm::pool_health_t& message) {
  message.name = pool.name.view();
  message.capacity = static_cast<std::int32_t>(pool.capacity);
  message.low_water = static_cast<std::int32_t>(pool.low_water);
}

PoolHealth read_pool(const slamd_lcm::pool_health_t& message) {
  return {.name = std::string_view(message.name),
          .capacity = static_cast<std::uint32_t>(message.capacity),
          .low_water = static_cast<std::uint32_t>(message.low_water)};
}

void write_counter(const CounterHealth& counter, slamd_lcm::counter_health_t& message) {
  message.name = counter.name.view();
  message.value = static_cast<std::int64_t>(counter.value);
}

CounterHealth read_counter(const slamd_lcm::counter_health_t& message) {
  return {.name = std::string_view(message.name), .value = static_cast<std::uint64_t>(message.value)};
}

/// The order of fields is health_t.lcm's.
bool strings_stay_inside_health(std::span<const std::byte> bytes) {
  const auto skip_list = [](Walk& walk, std::size_t count, std::size_t bytes_after_name) {
    walk.skip(1);  // *_count
    for (std::size_t i = 0; i < count; ++i) {
      walk.skip_string();
      walk.skip(bytes_after_name);
    }
  };
  Walk walk(bytes);
  walk.skip(8 + 8 + 1 + 1 + 5 * 4);
  skip_list(walk, decltype(Health::causes)::capacity(), 0);
  skip_list(walk, decltype(Health::sensors)::capacity(), 1 + 1 + 4 + 3 * 8 + 4 + 4 + 4);
  skip_list(walk, decltype(Health::stages)::capacity(), 4 * 4);
  skip_list(walk, decltype(Health::pools)::capacity(), 2 * 4);
  skip_list(walk, decltype(Health::counters)::capacity(), 8);
  return walk.ends_here();
}

}  // namespace

std::size_t encode(const Health& health, std::span<std::byte> buffer) {
  slamd_lcm::health_t message{};
  message.stamp_ns = ns_of(health.stamp);
  message.uptime_ns = health.uptime.count();
  message.state = static_cast<std::uint8_t>(health.state);
  message.weak_axes = health.weak_axes;
  message.swarm_use = health.swarm_use;
  message.particles = static_cast<std::int32_t>(health.particles);
  message.inlier_share = health.inlier_share;
  message.imu_offset_ms = health.imu_offset_ms;
  message.imu_offset_std_ms = health.imu_offset_std_ms;
  const auto fill = [](const auto& list, std::uint8_t& count, auto& destination, auto write_item) {
    static_assert(std::extent_v<std::remove_reference_t<decltype(destination)>> ==
                  std::remove_cvref_t<decltype(list)>::capacity());
    count = static_cast<std::uint8_t>(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      write_item(list[i], destination[i]);
    }
  };
  fill(health.causes, message.cause_count, message.causes, [](const auto& text, auto& m) { m = text.view(); });
  fill(health.sensors, message.sensor_count, message.sensors, &write_sensor);
  fill(health.stages, message.stage_count, message.stages, &write_stage);
  fill(health.pools, message.pool_count, message.pools, &write_pool);
  fill(health.counters, message.counter_count, message.counters, &write_counter);
  return write_raw(message, buffer);
}

std::optional<Health> decode_health(std::span<const std::byte> bytes) {
  slamd_lcm::health_t message;
  if (!strings_stay_inside_health(bytes) || !read_raw(bytes, message)) {
    return std::nullopt;
  }
  const auto state = read_enum(message.state, State::kRelocalising);
  if (!state || message.cause_count > decltype(Health::causes)::capacity() ||
      message.sensor_count > decltype(Health::sensors)::capacity() ||
      message.stage_count > decltype(Health::stages)::capacity() ||
      message.pool_count > decltype(Health::pools)::capacity() ||
      message.counter_count > decltype(Health::counters)::capacity()) {
    return std::nullopt;
  }
  Health health;
  health.stamp = stamp_of(message.stamp_ns);
  health.uptime = Duration(message.uptime_ns);
  health.state = *state;
  health.weak_axes = message.weak_axes;
  health.swarm_use = message.swarm_use;
  health.particles = static_cast<std::uint32_t>(message.particles);
  health.inlier_share = message.inlier_share;
  health.imu_offset_ms = message.imu_offset_ms;
  health.imu_offset_std_ms = message.imu_offset_std_ms;
  for (std::size_t i = 0; i < message.cause_count; ++i) {
    health.causes.push_back(std::string_view(message.causes[i]));
  }
  for (std::size_t i = 0; i < message.sensor_count; ++i) {
    const auto sensor = read_sensor(message.sensors[i]);
    if (!sensor) {
      return std::nullopt;
    }
    health.sensors.push_back(*sensor);
  }
  for (std::size_t i = 0; i < message.stage_count; ++i) {
    health.stages.push_back(read_stage(message.stages[i]));
  }
  for (std::size_t i = 0; i < message.pool_count; ++i) {
    health.pools.push_back(read_pool(message.pools[i]));
  }
  for (std::size_t i = 0; i < message.counter_count; ++i) {
    health.counters.push_back(read_counter(message.counters[i]));
  }
  return health;
}

std::size_t encode(const Command& command, std::span<std::byte> buffer) {
  slamd_lcm::command_t message;
  if (command.arguments.size() > Command::kMaxArguments) {
    return 0;
  }
  message.id = static_cast<std::int64_t>(command.id);
  message.verb = command.verb;
  message.argument_count = static_cast<std::uint8_t>(command.arguments.size());
  std::copy(command.arguments.begin(), command.arguments.end(), message.arguments);
  return write_raw(message, buffer);
}

std::optional<Command> decode_command(std::span<const std::byte> bytes) {
  Walk walk(bytes);
  walk.skip(8);
  walk.skip_string();
  walk.skip(1);
  for (std::size_t i = 0; i < Command::kMaxArguments; ++i) {
    walk.skip_string();
  }
  slamd_lcm::command_t message;
  if (!walk.ends_here() || !read_raw(bytes, message) || message.argument_count > Command::kMaxArguments) {
    return std::nullopt;
  }
  return Command{.id = static_cast<std::uint64_t>(message.id),
                 .verb = message.verb,
                 .arguments = {message.arguments, message.arguments + message.argument_count}};
}

std::size_t encode(const Reply& reply, std::span<std::byte> buffer) {
  slamd_lcm::reply_t message;
  message.id = static_cast<std::int64_t>(reply.id);
  message.ok = reply.ok ? 1 : 0;
  message.text = reply.text.substr(0, kLongestReply_bytes);
  return write_raw(message, buffer);
}

std::optional<Reply> decode_reply(std::span<const std::byte> bytes) {
  Walk walk(bytes);
  walk.skip(8 + 1);
  walk.skip_string();
  slamd_lcm::reply_t message;
  if (!walk.ends_here() || !read_raw(bytes, message)) {
    return std::nullopt;
  }
  return Reply{.id = static_cast<std::uint64_t>(message.id), .ok = message.ok != 0, .text = message.text};
}

std::size_t encode(const VelocityCommand& command, std::span<std::byte> buffer) {
  slamd_lcm::velocity_command_t message;
  message.stamp_ns = ns_of(command.stamp);
  message.v_m_s = command.v_mps;
  message.w_rad_s = command.w_radps;
  return write_raw(message, buffer);
}

std::optional<VelocityCommand> decode_velocity_command(std::span<const std::byte> bytes) {
  slamd_lcm::velocity_command_t message;
  if (!read_raw(bytes, message) || !std::isfinite(message.v_m_s) || !std::isfinite(message.w_rad_s)) {
    return std::nullopt;
  }
  return VelocityCommand{.stamp = stamp_of(message.stamp_ns), .v_mps = message.v_m_s, .w_radps = message.w_rad_s};
}

std::size_t encode(const Truth& truth, std::span<std::byte> buffer) {
  slamd_lcm::truth_t message;
  message.stamp_ns = ns_of(truth.stamp);
  write_transform(truth.T_world_base, message.position_world_m, message.quaternion_world_base);
  Eigen::Vector3d::Map(message.velocity_world_mps) = truth.v_world_base;
  Eigen::Vector3d::Map(message.rate_base_radps) = truth.rate_base_radps;
  message.collisions = static_cast<std::int32_t>(truth.collisions);
  return write_raw(message, buffer);
}

std::optional<Truth> decode_truth(std::span<const std::byte> bytes) {
  slamd_lcm::truth_t message;
  if (!read_raw(bytes, message)) {
    return std::nullopt;
  }
  const auto T_world_base = read_transform(message.position_world_m, message.quaternion_world_base);
  if (!T_world_base) {
    return std::nullopt;
  }
  return Truth{.stamp = stamp_of(message.stamp_ns),
               .T_world_base = *T_world_base,
               .v_world_base = Eigen::Vector3d::Map(message.velocity_world_mps),
               .rate_base_radps = Eigen::Vector3d::Map(message.rate_base_radps),
               .collisions = static_cast<std::uint32_t>(message.collisions)};
}

}  // namespace slamd::bus
