#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "daemon/bus/channels.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/messages.hpp"
#include "daemon/bus/scan_chunks.hpp"

namespace slamd::status {

using Clock = std::chrono::steady_clock;

/// What has been heard of one daemon.
struct Heard {
  template <typename Message>
  struct Newest {
    std::optional<Message> message;
    Clock::time_point when{};
    std::uint64_t count = 0;
  };

  Newest<bus::Pose> pose;
  Newest<bus::MapToOdom> map_to_odom;
  Newest<bus::Health> health;
  std::uint64_t scans = 0;             // complete
  std::uint64_t scans_incomplete = 0;  // chunks missing
  std::uint64_t malformed = 0;
  double pose_rate_hz = 0.0;  // over the last seconds

  /// Tells whether any message of the daemon has come.
  bool anything() const { return pose.message || map_to_odom.message || health.message || scans > 0; }
};

/// Collects a daemon's messages from a connection that outlives it.
/// Threads: one.
class Listener {
 public:
  Listener(bus::Connection& connection, const std::string& prefix);
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  /// Takes in what comes until then.
  void listen_until(Clock::time_point end);

  /// Returns when a health message is there, or then.
  void listen_for_health(Clock::time_point end);

  const Heard& heard() const { return heard_; }

  /// Calls `take` with every pose that comes from now on.
  void on_pose(std::function<void(const bus::Pose&)> take) { take_pose_ = std::move(take); }

  /// Calls `take` with every truth that a driven simulation tells from now on.
  void on_truth(std::function<void(const bus::Truth&)> take);

 private:
  void count_rate(Clock::time_point now);

  bus::Connection& connection_;
  bus::Channels channels_;
  bus::ScanAssembly assembly_;
  std::function<void(const bus::Pose&)> take_pose_;
  Heard heard_;
  Clock::time_point rate_begin_{};
  std::uint64_t rate_count_ = 0;
};

/// The exit code of --once: 0 TRACKING, 1 no health heard, 3 another state.
int exit_code_of(const Heard& heard);

}  // namespace slamd::status
