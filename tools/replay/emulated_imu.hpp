#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "core/sensor/imu_sample.hpp"
#include "drivers/imu/imu_stream.hpp"

namespace slamd::replay {

/// The device's side of an inertial sensor on a serial line: samples as it sends them, and answers to its host.
class EmulatedImu {
 public:
  virtual ~EmulatedImu() = default;

  /// Takes what the host has sent, and appends what the device answers.
  virtual void hear(std::span<const std::byte> bytes, std::string& out) = 0;

  /// Lets a sample be due, and appends it as it is sent. Returns false, and appends nothing, when the device is being
  /// configured or sends at a lower rate.
  virtual bool sample(const sensor::ImuSample& sample, std::string& out) = 0;

  /// What a new reader hears first.
  virtual std::string greeting() const { return {}; }
};

/// Makes a device that measures rate_hz samples a second and sends them all until it is told otherwise.
std::unique_ptr<EmulatedImu> emulated_imu(imu::Protocol protocol, int rate_hz);

/// A sample as a row of the canonical CSV, which reads back to the same bits.
std::string row_of(const sensor::ImuSample& sample);

}  // namespace slamd::replay
