#include "tools/replay/can_log.hpp"

namespace slamd::replay {

namespace {

/// What is in the log beside frames of use.
void add_lines(const recording::CandumpCounters& lines, stages::NamedCounts& counts) {
  for (const auto& [name, count] : {std::pair{"foreign_frame", lines.foreign}, std::pair{"refused_line_without_data", lines.other},
                                    std::pair{"refused_line_malformed", lines.malformed}}) {
    if (count != 0) {
      counts.emplace_back(name, count);
    }
  }
}

}  // namespace

bool CanLogImu::next(sensor::ImuSample& sample) {
  transport::CanFrame frame;
  sensor::ImuReading reading;
  while (reader_.next(frame)) {
    if (stage_.take_imu(frame, reading)) {
      sample = {clock_.map(reading.device_stamp, reading.received), reading.angular_rate_radps, reading.specific_force_mps2};
      return true;
    }
  }
  return false;
}

stages::NamedCounts CanLogImu::counts() const {
  stages::NamedCounts counts = stage_.inertial();
  add_lines(reader_.counters(), counts);
  return counts;
}

bool CanLogWheels::next(sensor::WheelSample& sample) {
  transport::CanFrame frame;
  while (reader_.next(frame)) {
    if (stage_.take_wheels(frame, sample)) {
      return true;
    }
  }
  return false;
}

stages::NamedCounts CanLogWheels::counts() const {
  stages::NamedCounts counts = stage_.wheels();
  add_lines(reader_.counters(), counts);
  return counts;
}

}  // namespace slamd::replay
