#include "daemon/bus/map_request_listener.hpp"

#include <algorithm>
#include <utility>

#include "core/base/stamp.hpp"
#include "daemon/bus/channels.hpp"
#include "daemon/bus/map_encoding.hpp"

namespace slamd::bus {

MapRequestListener::MapRequestListener(const std::shared_ptr<Connection>& connection, const std::string& prefix, Handler handler)
    : handler_(std::move(handler)) {
  connection->subscribe(Channels(prefix).map_request, [this](std::span<const std::byte> message) { take(message, Clock::now()); });
}

void MapRequestListener::take(std::span<const std::byte> message, Clock::time_point now) {
  const double passed_s = filled_ == Clock::time_point{} ? 0.0 : to_seconds(now - filled_);
  tokens_ = std::min<double>(kBurst, tokens_ + kPerSecond * passed_s);
  filled_ = now;
  if (tokens_ < 1.0) {
    ++counters_.limited;
    return;
  }
  tokens_ -= 1.0;
  const auto request = decode_map_request(message);
  if (!request) {
    ++counters_.malformed;
    return;
  }
  ++counters_.accepted;
  handler_(*request);
}

}  // namespace slamd::bus
