#pragma once

#include <filesystem>

#include "core/sensor/clock_model.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/wheel_sample.hpp"
#include "daemon/stages/can_stage.hpp"
#include "drivers/recording/candump.hpp"

namespace slamd::replay {

/// The inertial samples in a candump log, as the daemon would have made them of the frames.
class CanLogImu {
 public:
  /// Errors: RecordingError.
  CanLogImu(const std::filesystem::path& file, const configuration::Configuration& configuration)
      : reader_(file, configuration.imu.interface), stage_(configuration), clock_(stages::imu_clock(configuration.imu)) {}

  bool next(sensor::ImuSample& sample);

  /// Frames and lines by what became of them.
  stages::NamedCounts counts() const;

 private:
  recording::CandumpReader reader_;
  stages::CanStage stage_;
  sensor::ClockModel clock_;
};

/// The wheels' samples in a candump log, likewise.
class CanLogWheels {
 public:
  /// Errors: RecordingError.
  CanLogWheels(const std::filesystem::path& file, const configuration::Configuration& configuration)
      : reader_(file, configuration.wheel.interface), stage_(configuration) {}

  bool next(sensor::WheelSample& sample);

  stages::NamedCounts counts() const;

 private:
  recording::CandumpReader reader_;
  stages::CanStage stage_;
};

}  // namespace slamd::replay
