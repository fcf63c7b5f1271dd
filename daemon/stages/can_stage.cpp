#include "daemon/stages/can_stage.hpp"

#include "core/base/assert.hpp"
#include "daemon/configuration/can.hpp"

namespace slamd::stages {

using configuration::ImuConfiguration;
using configuration::WheelConfiguration;
using transport::CanFilter;
using transport::CanFrame;

namespace {

std::optional<std::uint8_t> address_of(const ImuConfiguration& imu) {
  return imu.can_address < 0 ? std::nullopt : std::optional(static_cast<std::uint8_t>(imu.can_address));
}

can::AceinnaReader aceinna(const ImuConfiguration& imu) {
  const std::optional<can::AxisMap> axes = can::parse_axis_map(imu.axis_map);
  SLAMD_ASSERT(axes);  // the loader has seen to it
  return can::AceinnaReader(*axes, address_of(imu));
}

/// The names with their counts, but for those that did not happen.
template <typename Result, typename Counts>
NamedCounts named(const Counts& counts) {
  NamedCounts all;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (i == 0 || counts[i] != 0) {
      all.emplace_back(name_of(static_cast<Result>(i)), counts[i]);
    }
  }
  return all;
}

}  // namespace

CanStage::CanStage(const configuration::Configuration& configuration)
    : takes_imu_(configuration.imu.enabled && configuration.imu.is_on_can()) {
  if (takes_imu_ && configuration.imu.protocol == imu::Protocol::kAceinna) {
    imu_.emplace<can::AceinnaReader>(aceinna(configuration.imu));
  }
  if (configuration.wheel.use && configuration.wheel.is_on_can()) {
    wheels_.emplace(configuration::wheel_signals(configuration.wheel));
  }
}

bool CanStage::take_imu(const CanFrame& frame, sensor::ImuReading& reading) {
  if (auto* xsens = std::get_if<can::XsensCanReader>(&imu_)) {
    return xsens->take(frame, reading);
  }
  return std::get<can::AceinnaReader>(imu_).take(frame, reading);
}

bool CanStage::take_wheels(const CanFrame& frame, sensor::WheelSample& sample) {
  return wheels_ && wheels_->take(frame, sample);
}

const imu::InertialCounters& CanStage::imu_counters() const {
  if (const auto* xsens = std::get_if<can::XsensCanReader>(&imu_)) {
    return xsens->counters();
  }
  return std::get<can::AceinnaReader>(imu_).counters();
}

imu::StreamSummary CanStage::imu_summary() const {
  const imu::InertialCounters& counters = imu_counters();
  imu::StreamSummary summary{counters.of(imu::InertialResult::kSample), 0, counters.missing, counters.clipped};
  for (std::size_t i = static_cast<std::size_t>(imu::InertialResult::kIncomplete); i < imu::kInertialResults; ++i) {
    summary.refused += counters.frames[i];
  }
  return summary;
}

std::uint64_t CanStage::wheels_refused() const {
  using can::WheelResult;
  return wheels_ ? wheels_->of(WheelResult::kIncomplete) + wheels_->of(WheelResult::kMalformed) + wheels_->of(WheelResult::kOutOfRange)
                 : 0;
}

NamedCounts CanStage::inertial() const {
  const imu::InertialCounters& counters = imu_counters();
  NamedCounts all = named<imu::InertialResult>(counters.frames);
  for (const auto& [name, count] : {std::pair{"missing", counters.missing}, std::pair{"clipped", counters.clipped}}) {
    if (count != 0) {
      all.emplace_back(name, count);
    }
  }
  return all;
}

NamedCounts CanStage::wheels() const { return wheels_ ? named<can::WheelResult>(wheels_->counts()) : NamedCounts{}; }

std::vector<CanFilter> imu_frames(const ImuConfiguration& imu) {
  return imu.protocol == imu::Protocol::kAceinna ? can::AceinnaReader::frames(address_of(imu)) : can::XsensCanReader::frames();
}

std::vector<CanFilter> wheel_frames(const WheelConfiguration& wheel) {
  std::vector<CanFilter> filters;
  for (const can::CanSignal& signal : configuration::wheel_signals(wheel).signals) {
    const CanFilter filter{.id = signal.id, .is_extended = signal.is_extended};
    if (filters.empty() || filters.back() != filter) {
      filters.push_back(filter);
    }
  }
  return filters;
}

sensor::ClockConfig imu_clock(const ImuConfiguration& imu) {
  const bool by_arrival = imu.is_on_can() && imu.protocol == imu::Protocol::kAceinna;
  sensor::ClockConfig config;
  config.kind = by_arrival || imu.clock == configuration::SensorClock::kShared ? sensor::ClockKind::kShared : sensor::ClockKind::kEstimated;
  return config;
}

}  // namespace slamd::stages
