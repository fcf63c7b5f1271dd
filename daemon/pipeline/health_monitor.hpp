#pragma once

#include <string>

#include "daemon/bus/messages.hpp"
#include "daemon/pipeline/pipeline.hpp"

namespace slamd::pipeline {

/// Makes the health page of what the threads show: states, causes in words, rates.
/// Threads: housekeeping.
class HealthMonitor {
 public:
  HealthMonitor(const configuration::Configuration& configuration, Stamp started);

  /// device_cause: what the LiDAR's device itself says is wrong; empty: nothing.
  bus::Health read(const Pipeline& pipeline, Stamp now, const std::string& device_cause = {});

 private:
  struct Rate {
    std::uint64_t count = 0;
    Stamp at{};
    double hz = 0.0;

    void update(std::uint64_t new_count, Stamp now);
  };

  bus::SensorHealth lidar(const Pipeline& pipeline, Stamp now);
  bus::SensorHealth imu(const Pipeline& pipeline, Stamp now);
  bus::SensorHealth gnss(const Pipeline& pipeline, Stamp now);
  bus::SensorHealth wheels(const Pipeline& pipeline, Stamp now);
  void add_causes(const Pipeline& pipeline, Stamp now, bus::Health& health) const;
  template <typename Say>
  void add_odometry_causes(const Pipeline& pipeline, Stamp now, Say&& say) const;

  std::string lidar_name_;
  bool imu_enabled_;
  bool wheels_enabled_;
  bool shared_clock_;
  bool gnss_enabled_;
  double imu_offset_s_;       // as configured
  geometry::Se3 T_base_imu_;  // likewise
  Stamp started_;
  Rate scans_;
  Rate samples_;
  Rate fixes_;
  Rate wheel_samples_;
};

/// Says what a satellite receiver lacks; empty: it has a fix.
std::string gnss_cause(const stages::GnssState& state, Stamp now);

/// Names an event's cause: events of the same one are repetitions of each other, whatever numbers they carry.
std::string cause_of(const threads::EventRecord& record);

/// Says an event in words.
std::string sentence(const threads::EventRecord& record);

}  // namespace slamd::pipeline
