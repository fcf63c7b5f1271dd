#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "core/sensor/clock_model.hpp"
#include "core/sensor/imu_reading.hpp"
#include "core/sensor/wheel_sample.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/stages/packet_stage.hpp"
#include "drivers/can/aceinna_imu.hpp"
#include "drivers/can/wheel_signals.hpp"
#include "drivers/can/xsens_can.hpp"
#include "drivers/imu/imu_stream.hpp"
#include "drivers/transport/can_socket.hpp"

namespace slamd::stages {

/// CAN frames to what the inertial sensor and the wheels say with them, as configured; live and in a replay.
/// Real-time: allocates in the constructor only; one thread.
class CanStage {
 public:
  explicit CanStage(const configuration::Configuration& configuration);

  /// Tells whether the inertial sensor, and the wheels, are on CAN.
  bool takes_imu() const { return takes_imu_; }
  bool takes_wheels() const { return wheels_.has_value(); }

  /// Takes a frame of the inertial sensor's bus. Returns true when it completes a reading, which is then in `reading`.
  bool take_imu(const transport::CanFrame& frame, sensor::ImuReading& reading);

  /// Takes a frame of the wheels' bus. Returns true when it completes a sample, which is then in `sample`.
  bool take_wheels(const transport::CanFrame& frame, sensor::WheelSample& sample);

  /// What became of the inertial sensor's frames.
  imu::StreamSummary imu_summary() const;

  /// Numbers of the wheels that came and are no sample, though they should be.
  std::uint64_t wheels_refused() const;

  /// By what became of them, the samples first.
  NamedCounts inertial() const;
  NamedCounts wheels() const;

 private:
  const imu::InertialCounters& imu_counters() const;

  bool takes_imu_;
  std::variant<can::XsensCanReader, can::AceinnaReader> imu_;
  std::optional<can::WheelReader> wheels_;
};

/// Returns the frames that the inertial sensor's samples are made of, and those of the wheels.
std::vector<transport::CanFilter> imu_frames(const configuration::ImuConfiguration& imu);
std::vector<transport::CanFilter> wheel_frames(const configuration::WheelConfiguration& wheel);

/// Says whose time an inertial sensor's stamps tell. An Aceinna tells none: its readings are stamped by arrival.
sensor::ClockConfig imu_clock(const configuration::ImuConfiguration& imu);

}  // namespace slamd::stages
