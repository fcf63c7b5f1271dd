#include "daemon/pipeline/can_input.hpp"

#include <algorithm>

namespace slamd::pipeline {

using configuration::Configuration;
using threads::Event;
using transport::CanCounters;
using transport::CanFilter;
using transport::CanSocket;

CanInput::CanInput(const Configuration& configuration, const transport::HostClock& clock) : stage_(configuration) {
  const bool has_imu = stage_.takes_imu();
  const bool has_wheels = stage_.takes_wheels();
  const bool shared = has_imu && has_wheels && configuration.imu.interface == configuration.wheel.interface;
  const auto add = [&](const std::string& interface, bool with_imu, bool with_wheels) {
    std::vector<CanFilter> filters;
    const auto want = [&](const std::vector<CanFilter>& more) { filters.insert(filters.end(), more.begin(), more.end()); };
    if (with_imu) {
      want(stages::imu_frames(configuration.imu));
    }
    if (with_wheels) {
      want(stages::wheel_frames(configuration.wheel));
    }
    buses_.push_back({std::make_unique<CanSocket>(transport::CanSocketConfig{.interface = interface, .filters = filters}, clock),
                      with_imu, with_wheels, {}, {}});
    buses_.back().socket->attend();
  };
  if (has_imu) {
    add(configuration.imu.interface, true, shared);
  }
  if (has_wheels && !shared) {
    add(configuration.wheel.interface, false, true);
  }
}

void CanInput::tell(Stamp now, threads::EventRing& events) {
  constexpr std::pair<std::uint64_t CanCounters::*, Event> kTold[] = {
      {&CanCounters::bus_off, Event::kCanBusOff},         {&CanCounters::restarted, Event::kCanRestarted},
      {&CanCounters::warnings, Event::kCanWarning},       {&CanCounters::passive, Event::kCanPassive},
      {&CanCounters::kernel_lost, Event::kCanKernelLost}, {&CanCounters::controller_lost, Event::kCanControllerLost}};
  for (Bus& bus : buses_) {
    const CanCounters counters = bus.socket->counters();
    for (const auto& [count, event] : kTold) {
      if (counters.*count != bus.said.*count) {
        events.write(now, event, static_cast<std::uint64_t>(bus.socket->interface_index()));
      }
    }
    bus.said = counters;
  }
}

std::uint64_t CanInput::imu_lost() const {
  return stage_.takes_imu() ? buses_.front().socket->counters().kernel_lost : 0;
}

std::uint64_t CanInput::wheels_lost() const {
  return stage_.takes_wheels() && !buses_.back().has_imu ? buses_.back().socket->counters().kernel_lost : 0;
}

CanCounters CanInput::counters() const {
  CanCounters sum;
  for (const Bus& bus : buses_) {
    const CanCounters more = bus.socket->counters();
    for (const auto count : {&CanCounters::received, &CanCounters::other, &CanCounters::kernel_lost, &CanCounters::controller_lost,
                             &CanCounters::bus_off, &CanCounters::restarted, &CanCounters::warnings, &CanCounters::passive}) {
      sum.*count += more.*count;
    }
  }
  return sum;
}

stages::NamedCounts CanInput::named_counts() const {
  const CanCounters sum = counters();
  stages::NamedCounts counts{{"received", sum.received}};
  const std::pair<const char*, std::uint64_t> others[] = {
      {"other", sum.other},         {"lost_in_the_kernel", sum.kernel_lost}, {"lost_in_the_controller", sum.controller_lost},
      {"bus_off", sum.bus_off},     {"restarted", sum.restarted},            {"warnings", sum.warnings},
      {"error_passive", sum.passive}};
  std::copy_if(std::begin(others), std::end(others), std::back_inserter(counts), [](const auto& named) { return named.second != 0; });
  return counts;
}

std::string CanInput::buffer_remark() const {
  for (const Bus& bus : buses_) {
    if (const std::string remark = bus.socket->buffer_remark(); !remark.empty()) {
      return remark;
    }
  }
  return "";
}

}  // namespace slamd::pipeline
