#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/occupancy/map_delta.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/rate_limit.hpp"

namespace slamd::bus {

/// What became of the requests that came; for health.
struct MapRequestCounters {
  std::uint64_t accepted = 0;
  std::uint64_t malformed = 0;  // no map_request_t, or one with ranges that are none
  std::uint64_t limited = 0;    // more than kBurst at once or kPerSecond on average: dropped; what was asked for comes as key blocks, too
};

/// Takes clients' requests for parts of the map from the bus and hands them on, as many as are worth it. However often
/// clients ask, what they get is bounded by occupancy::DeltaConfig.
/// Threads: that which wait()s on the connection. Real-time: no; for the housekeeping thread.
class MapRequestListener {
 public:
  using Clock = std::chrono::steady_clock;
  using Handler = std::function<void(const occupancy::MapRequest&)>;
  static constexpr int kBurst = 40;
  static constexpr int kPerSecond = 20;

  MapRequestListener(const std::shared_ptr<Connection>& connection, const std::string& prefix, Handler handler);
  MapRequestListener(const MapRequestListener&) = delete;
  MapRequestListener& operator=(const MapRequestListener&) = delete;

  /// Takes a message at a time of the caller's clock.
  void take(std::span<const std::byte> message, Clock::time_point now);

  const MapRequestCounters& counters() const { return counters_; }

 private:
  Handler handler_;
  MapRequestCounters counters_;
  RateLimit limit_{kBurst, kPerSecond};
};

}  // namespace slamd::bus
