#include "daemon/pipeline/serial_loop.hpp"

#include <algorithm>
#include <thread>

#include <poll.h>

namespace slamd::pipeline {

using threads::Event;

namespace {

/// The conversation with the sensor looks at its time at least so often.
constexpr Duration kTick = std::chrono::milliseconds(10);

Event event_of(imu::LineEvent::Kind kind) {
  switch (kind) {
    case imu::LineEvent::Kind::kFound: return Event::kSerialFound;
    case imu::LineEvent::Kind::kConfigured: return Event::kImuConfigured;
    case imu::LineEvent::Kind::kRefused: return Event::kImuRefused;
    case imu::LineEvent::Kind::kTakenAsItIs: return Event::kImuTakenAsItIs;
    default: return Event::kImuMute;
  }
}

}  // namespace

SerialLoop::SerialLoop(const configuration::Configuration& configuration, const transport::HostClock& clock, SerialLine& line)
    : clock_(clock),
      line_(line),
      setup_({configuration.imu.protocol, configuration.imu.baud, configuration.imu.rate_hz}) {}

void SerialLoop::run_once(Duration longest) {
  if (!line_.wait_for_return(longest)) {
    return;
  }
  if (handed_on_ || line_.port().is_gone()) {
    close();
  }
  if (line_.port().is_open()) {
    set_up(longest);
  } else if (const Duration until = next_try_ - clock_.now(); until > Duration::zero()) {
    std::this_thread::sleep_for(std::min(until, longest));
  } else {
    open();
  }
}

void SerialLoop::close() {
  events_.write(clock_.now(), line_.port().is_gone() ? Event::kSerialLost : Event::kSerialSilent);
  line_.port().close();
  handed_on_ = false;
  next_try_ = clock_.now() + kRetry;
}

void SerialLoop::open() {
  imu::LineOutput out;
  setup_.begin(clock_.now(), out);
  line_.port().set_baud(setup_.baud());
  const int error = line_.port().open();
  next_try_ = clock_.now() + kRetry;
  if (error != 0) {
    if (error != refused_) {
      events_.write(clock_.now(), Event::kSerialRefused, static_cast<std::uint64_t>(error));
    }
    refused_ = error;
    return;
  }
  refused_ = 0;
  events_.write(clock_.now(), Event::kSerialOpen);
  carry_out(out);
  set_up(Duration{});
}

void SerialLoop::set_up(Duration longest) {
  std::span<const std::byte> rest;
  if (!setup_.is_ready()) {
    const auto timeout_ms = std::chrono::duration_cast<std::chrono::milliseconds>(std::min(longest, kTick));
    pollfd entry{line_.port().fd(), POLLIN, 0};
    poll(&entry, 1, static_cast<int>(timeout_ms.count()));
    imu::LineOutput out;
    const std::span<const std::byte> bytes = line_.port().read();
    rest = bytes.subspan(setup_.receive(bytes, clock_.now(), out));
    setup_.advance(clock_.now(), out);
    carry_out(out);
  }
  if (setup_.is_ready() && !line_.port().is_gone()) {
    handed_on_ = true;
    line_.hand_on(rest);
  }
}

void SerialLoop::carry_out(imu::LineOutput& out) {
  if (setup_.baud() != line_.port().baud()) {
    line_.port().set_baud(setup_.baud());
  }
  line_.port().write(out.bytes.view());
  for (const imu::LineEvent& event : out.events) {
    events_.write(clock_.now(), event_of(event.kind), event.value);
  }
}

}  // namespace slamd::pipeline
