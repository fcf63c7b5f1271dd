#include "daemon/bus/map_request_listener.hpp"

#include <utility>

#include "daemon/bus/channels.hpp"
#include "daemon/bus/map_encoding.hpp"

namespace slamd::bus {

MapRequestListener::MapRequestListener(const std::shared_ptr<Connection>& connection, const std::string& prefix, Handler handler)
    : handler_(std::move(handler)) {
  connection->subscribe(Channels(prefix).map_request, [this](std::span<const std::byte> message) { take(message, Clock::now()); });
}

void MapRequestListener::take(std::span<const std::byte> message, Clock::time_point now) {
  if (!limit_.admits(now)) {
    ++counters_.limited;
    return;
  }
  const auto request = decode_map_request(message);
  if (!request) {
    ++counters_.malformed;
    return;
  }
  ++counters_.accepted;
  handler_(*request);
}

}  // namespace slamd::bus
