#include "daemon/pipeline/gnss_loop.hpp"

#include <algorithm>
#include <thread>

#include <poll.h>

namespace slamd::pipeline {

using configuration::Configuration;
using threads::Event;

namespace {

transport::SerialPortConfig port_config(const Configuration& configuration) {
  transport::SerialPortConfig config;
  config.device = configuration.gnss.device;
  config.baud = configuration.gnss.baud == 0 ? transport::BaudHunt::kRates.front() : configuration.gnss.baud;
  return config;
}

}  // namespace

GnssLoop::GnssLoop(const Configuration& configuration, const transport::HostClock& clock)
    : clock_(clock), port_(port_config(configuration)), hunts_(configuration.gnss.baud == 0) {}

void GnssLoop::run_once(Duration longest) {
  if (port_.is_open()) {
    read(longest);
  } else {
    open(longest);
  }
  if (const bool has_fix = stage_.state().has_fix(); has_fix != had_fix_) {
    had_fix_ = has_fix;
    events_.write(clock_.now(), has_fix ? Event::kGnssFix : Event::kGnssNoFix);
  }
  shown_.store(stage_.state());
}

void GnssLoop::open(Duration longest) {
  const Stamp now = clock_.now();
  if (now < next_try_) {
    std::this_thread::sleep_for(std::min(next_try_ - now, longest));
    return;
  }
  next_try_ = now + kRetry;
  if (hunts_) {
    hunt_.begin(now);
    port_.set_baud(hunt_.baud());
  }
  const int error = port_.open();
  if (error != 0 && error != refused_) {
    events_.write(now, Event::kSerialRefused, static_cast<std::uint64_t>(error));
  }
  refused_ = error;
  if (error == 0) {
    events_.write(now, Event::kSerialOpen);
    was_found_ = !hunts_;
    heard_ = now;
  }
}

void GnssLoop::read(Duration longest) {
  const auto timeout_ms = std::chrono::duration_cast<std::chrono::milliseconds>(longest);
  pollfd entry{port_.fd(), POLLIN, 0};
  poll(&entry, 1, static_cast<int>(timeout_ms.count()));
  const std::uint64_t before = stage_.messages();
  const Stamp now = clock_.now();
  stage_.add(port_.read(), now);
  if (port_.is_gone()) {
    close();
    return;
  }
  listen(now, stage_.messages() - before);
}

/// Looks for the rate, as long as it is not known.
void GnssLoop::listen(Stamp now, std::uint64_t messages) {
  heard_ = messages != 0 ? now : heard_;
  if (!hunts_) {
    return;
  }
  for (std::uint64_t i = 0; i < messages; ++i) {
    hunt_.hear(now);
  }
  if (hunt_.found() && !was_found_) {
    was_found_ = true;
    events_.write(now, Event::kGnssFound, static_cast<std::uint64_t>(port_.baud()));
  }
  if (hunt_.found() && now - heard_ > kMute) {
    was_found_ = false;
    heard_ = now;
    hunt_.begin(now);
  }
  if (hunt_.advance(now)) {
    stage_.finish(now);
    port_.set_baud(hunt_.baud());
  }
}

void GnssLoop::close() {
  const Stamp now = clock_.now();
  events_.write(now, Event::kSerialLost);
  stage_.finish(now);
  port_.close();
  next_try_ = now + kRetry;
}

}  // namespace slamd::pipeline
