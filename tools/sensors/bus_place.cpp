#include "tools/sensors/bus_place.hpp"

namespace slamd::sensors {

namespace {

constexpr int kMostBatches = 32;  // at once

}  // namespace

BusPlace::BusPlace(const std::string& interface, const transport::HostClock& clock) : interface_(interface) {
  try {
    socket_ = std::make_unique<transport::CanSocket>(transport::CanSocketConfig{.interface = interface, .filters = {}}, clock);
    attend();
  } catch (const transport::TransportError& error) {
    trouble_ = error.what();
  }
}

void BusPlace::attend() {
  if (socket_) {
    const transport::CanLink link = socket_->attend();
    trouble_ = link == transport::CanLink::kUp ? "" : in_words(link);
  }
}

void BusPlace::run_once() {
  for (int i = 0; socket_ && i < kMostBatches; ++i) {
    if (socket_->receive([&](const transport::CanFrame& frame) { watch_.take(frame); }) == 0) {
      break;
    }
  }
}

BusSeen BusPlace::seen() const {
  BusSeen seen = watch_.seen();
  seen.interface = printable(interface_);
  seen.trouble = trouble_;
  if (socket_) {
    const transport::CanCounters counters = socket_->counters();
    seen.lost = counters.kernel_lost + counters.controller_lost;
    seen.bus_off = counters.bus_off;
  }
  return seen;
}

}  // namespace slamd::sensors
