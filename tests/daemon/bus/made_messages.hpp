#pragma once

#include <algorithm>
#include <string>

#include "daemon/bus/messages.hpp"

namespace slamd::bus {

/// A pose in which no two numbers are alike.
inline Pose made_pose() {
  Pose pose;
  pose.stamp = Stamp(Duration(1'700'000'000'123'456'789));
  pose.age = std::chrono::microseconds(250);
  pose.T_odom_base = geometry::Se3(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), Eigen::Vector3d(1.0, -2.0, 0.5));
  pose.v_odom_base = {3.0, -4.0, 5.0};
  pose.rate_base_radps = {0.25, 0.5, -1.0};
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      pose.P_odom_base(row, column) = std::min(row, column) * 10 + std::max(row, column);
    }
  }
  pose.P_velocity_odom << 1.0, 0.5, 0.25, 0.5, 2.0, 0.125, 0.25, 0.125, 3.0;
  pose.reset_counter = 7;
  pose.correction_id = 9;
  pose.state = State::kDegraded;
  pose.cause = Cause::kDegenerate;
  pose.weak_axes = 0b000101;
  return pose;
}

/// A health message whose every list and text is full.
inline Health full_health() {
  Health health;
  health.stamp = Stamp(Duration(1'700'000'000'000'000'000));
  health.uptime = std::chrono::seconds(12);
  health.state = State::kLost;
  health.weak_axes = 3;
  health.swarm_use = 0.25F;
  health.particles = 64;
  health.inlier_share = 0.75F;
  health.imu_offset_ms = -2.5F;
  health.imu_offset_std_ms = 0.25F;
  while (health.causes.try_push_back(std::string(200, 'c'))) {
  }
  while (health.sensors.try_push_back({.name = std::string(200, 's'),
                                       .state = SensorState::kSilent,
                                       .time = TimeState::kLocked,
                                       .rate_hz = 10.5F,
                                       .received = 1'000'000'000'000,
                                       .lost = 2,
                                       .dropped = 3,
                                       .time_residual_us = 40.0F,
                                       .time_skew_ppm = -12.0F,
                                       .time_steps = 5})) {
  }
  while (health.stages.try_push_back(
      {.name = std::string(200, 'g'), .p50_us = 1.0F, .p99_us = 2.0F, .max_us = 3.0F, .count = 4})) {
  }
  while (health.pools.try_push_back({.name = std::string(200, 'p'), .capacity = 8, .low_water = 6})) {
  }
  while (health.counters.try_push_back({.name = std::string(200, 'n'), .value = 1'000'000'000'001})) {
  }
  return health;
}

}  // namespace slamd::bus
