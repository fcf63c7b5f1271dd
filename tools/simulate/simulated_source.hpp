#pragma once

#include <deque>
#include <optional>

#include "core/evaluation/trajectory.hpp"
#include "tools/replay/replay.hpp"
#include "tools/simulate/fault_injector.hpp"
#include "tools/simulate/packet_stream.hpp"

namespace slamd::simulate {

/// A drive as a source for replay: what a recording of it would hold, without the files; with the drive's faults.
class SimulatedSource : public replay::PacketSource {
 public:
  explicit SimulatedSource(const Scene& scene);

  bool next(recording::Packet& packet) override;
  bool next_imu(sensor::ImuSample& sample) override;
  bool next_wheel(sensor::WheelSample& sample) override;
  double progress() const override { return stream_.progress(); }

  /// What was done to what was given out; nullptr without faults.
  const FaultCounts* faults() { return injector_ ? &injector_->counts() : nullptr; }

 private:
  struct Damaged {
    recording::Packet packet;
    std::vector<std::byte> payload;
  };

  PacketStream stream_;
  InertialSensor imu_;
  WheelSensor wheels_;
  std::optional<FaultInjector> injector_;
  std::deque<Damaged> damaged_;  // the first was given out
  bool more_ = true;
};

/// The truth of a drive: T_world_base, 100 Hz.
evaluation::Trajectory truth_of(const Motion& motion);

/// The configuration that a recording of the drive would come with; `overrides` are "key=value".
/// Errors: ConfigurationError.
configuration::Configuration configuration_of(const Drive& drive, const std::vector<std::string>& overrides);

}  // namespace slamd::simulate
