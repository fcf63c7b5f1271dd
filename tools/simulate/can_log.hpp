#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "core/base/fixed_vector.hpp"
#include "core/sensor/imu_sample.hpp"
#include "drivers/can/wheel_signals.hpp"
#include "drivers/imu/protocol.hpp"
#include "drivers/transport/can_frame.hpp"
#include "tools/simulate/scene.hpp"

namespace slamd::simulate {

/// Speaks as an inertial sensor on a CAN bus of 500 kbit/s: an Xsens MTi-600, or an Aceinna with J1939's axes.
class CanImu {
 public:
  using Frames = FixedVector<transport::CanFrame, 4>;

  explicit CanImu(imu::Protocol protocol) : protocol_(protocol) {}

  /// Returns the frames of a sample, in the order and with the stamps of their arrival.
  /// Source: imu-can.md §A and §B.
  Frames frames_of(const sensor::ImuSample& sample);

 private:
  Frames xsens(const sensor::ImuSample& sample);
  static Frames aceinna(const sensor::ImuSample& sample);

  imu::Protocol protocol_;
  std::uint16_t counter_ = 0;
};

/// Where the simulated wheels' speeds are on the bus.
can::WheelSignals wheel_signals(double track_m);

/// Returns the frame with both speeds.
transport::CanFrame wheel_frame(const can::WheelSignals& signals, const WheelReading& reading, Stamp stamp);

/// The tables imu and wheel of a recording whose sensors are on CAN, without the sensor's place.
std::string can_toml(const Drive& drive);

/// Writes what both sensors send during a drive as candump -l would have.
void write_can_log(const Scene& scene, const std::filesystem::path& file);

}  // namespace slamd::simulate
