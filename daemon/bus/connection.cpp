#include "daemon/bus/connection.hpp"

#include <lcm/lcm.h>

namespace slamd::bus {

namespace {

void hand_on(const lcm_recv_buf_t* received, const char* /*channel*/, void* user) {
  const auto& handler = *static_cast<const Connection::Handler*>(user);
  handler({static_cast<const std::byte*>(received->data), received->data_size});
}

}  // namespace

Connection::Connection(const std::string& url) : url_(url), lcm_(lcm_create(url.c_str())) {
  if (lcm_ == nullptr) {
    throw BusError("LCM cannot open '" + url +
                   "': is the URL right, and is there a route for multicast? (ip route add 224.0.0.0/4 dev lo)");
  }
}

Connection::~Connection() {
  lcm_destroy(lcm_);
}

void Connection::subscribe(const std::string& channel, Handler handler, int queue) {
  handlers_.push_back(std::make_unique<Handler>(std::move(handler)));
  lcm_subscription_t* subscription = lcm_subscribe(lcm_, channel.c_str(), &hand_on, handlers_.back().get());
  if (subscription == nullptr) {
    throw BusError("LCM cannot listen for '" + channel + "' at '" + url_ + "': is the channel right, and may this host join the multicast group?");
  }
  lcm_subscription_set_queue_capacity(subscription, queue);
}

bool Connection::send(const std::string& channel, std::span<const std::byte> message) {
  return lcm_publish(lcm_, channel.c_str(), message.data(), static_cast<unsigned>(message.size())) == 0;
}

bool Connection::wait(std::chrono::milliseconds timeout) {
  return lcm_handle_timeout(lcm_, static_cast<int>(timeout.count())) > 0;
}

int Connection::fd() const {
  return lcm_get_fileno(lcm_);
}

}  // namespace slamd::bus
