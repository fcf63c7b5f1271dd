#include "tools/status/listener.hpp"

#include <algorithm>
#include <utility>

#include "core/base/stamp.hpp"
#include "daemon/bus/encoding.hpp"

namespace slamd::status {

Listener::Listener(bus::Connection& connection, const std::string& prefix) : connection_(connection), channels_(prefix) {
  const auto keep_newest = [this](auto& newest, auto decode) {
    return [this, &newest, decode](std::span<const std::byte> bytes) {
      if (auto message = decode(bytes)) {
        newest.message = std::move(message);
        newest.when = Clock::now();
        ++newest.count;
      } else {
        ++heard_.malformed;
      }
    };
  };
  const auto keep_pose = keep_newest(heard_.pose, &bus::decode_pose);
  connection.subscribe(channels_.pose, [this, keep_pose](std::span<const std::byte> bytes) {
    const std::uint64_t before = heard_.pose.count;
    keep_pose(bytes);
    if (take_pose_ && heard_.pose.count > before) {
      take_pose_(*heard_.pose.message);
    }
  });
  connection.subscribe(channels_.map_to_odom, keep_newest(heard_.map_to_odom, &bus::decode_map_to_odom));
  connection.subscribe(channels_.health, keep_newest(heard_.health, &bus::decode_health));
  connection.subscribe(channels_.scan, [this](std::span<const std::byte> bytes) {
    const auto chunk = bus::decode_scan_chunk(bytes);
    heard_.malformed += chunk ? 0 : 1;
    heard_.scans += chunk && assembly_.add(*chunk) ? 1 : 0;
    heard_.scans_incomplete = assembly_.incomplete() + assembly_.corrupt();
  });
}

void Listener::on_truth(std::function<void(const bus::Truth&)> take) {
  connection_.subscribe(channels_.truth, [this, take = std::move(take)](std::span<const std::byte> bytes) {
    if (const auto truth = bus::decode_truth(bytes)) {
      take(*truth);
    } else {
      ++heard_.malformed;
    }
  });
}

void Listener::listen_until(Clock::time_point end) {
  for (auto now = Clock::now(); now < end; now = Clock::now()) {
    connection_.wait(std::chrono::ceil<std::chrono::milliseconds>(end - now));
    count_rate(Clock::now());
  }
}

void Listener::listen_for_health(Clock::time_point end) {
  for (auto now = Clock::now(); now < end && !heard_.health.message; now = Clock::now()) {
    connection_.wait(std::chrono::ceil<std::chrono::milliseconds>(end - now));
    count_rate(Clock::now());
  }
}

void Listener::count_rate(Clock::time_point now) {
  if (rate_begin_ == Clock::time_point{}) {
    rate_begin_ = now;
    rate_count_ = heard_.pose.count;
  } else if (now - rate_begin_ >= std::chrono::seconds(1)) {
    heard_.pose_rate_hz = static_cast<double>(heard_.pose.count - rate_count_) / to_seconds(now - rate_begin_);
    rate_begin_ = now;
    rate_count_ = heard_.pose.count;
  }
}

int exit_code_of(const Heard& heard) {
  if (!heard.health.message) {
    return 1;
  }
  return heard.health.message->state == bus::State::kTracking ? 0 : 3;
}

}  // namespace slamd::status
