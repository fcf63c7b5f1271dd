#pragma once

#include "core/evaluation/trajectory.hpp"
#include "tools/replay/replay.hpp"
#include "tools/simulate/packet_stream.hpp"

namespace slamd::simulate {

/// A drive as a source for replay: what a recording of it would hold, without the files.
class SimulatedSource : public replay::PacketSource {
 public:
  explicit SimulatedSource(const Scene& scene)
      : stream_(scene),
        imu_(scene.imu()),
        wheels_(scene.motion(), kWheel_hz, scene.drive().wheel_errors, scene.drive().seed) {}

  bool next(recording::Packet& packet) override;
  bool next_imu(sensor::ImuSample& sample) override;
  bool next_wheel(sensor::WheelSample& sample) override;
  double progress() const override { return stream_.progress(); }

 private:
  PacketStream stream_;
  InertialSensor imu_;
  WheelSensor wheels_;
};

/// The truth of a drive: T_world_base, 100 Hz.
evaluation::Trajectory truth_of(const Motion& motion);

/// The configuration that a recording of the drive would come with; `overrides` are "key=value".
/// Errors: ConfigurationError.
configuration::Configuration configuration_of(const Drive& drive, const std::vector<std::string>& overrides);

}  // namespace slamd::simulate
