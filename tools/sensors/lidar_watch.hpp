#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/base/stamp.hpp"
#include "core/sensor/point_block.hpp"
#include "drivers/livox/host_event.hpp"
#include "drivers/livox/livox_decoder.hpp"
#include "drivers/livox/sdk1_messages.hpp"
#include "drivers/livox/sdk2_decoder.hpp"
#include "drivers/livox/sdk2_frame.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "tools/sensors/inertial_watch.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// A datagram that came to one of this host's ports.
struct Arrival {
  std::span<const std::byte> payload;
  std::uint32_t source = 0;  // host order
  std::uint16_t port = 0;    // of this host
  Stamp received{};
};

/// Watches what one LiDAR sends.  Any bytes may be given.  Threads: one.
class LidarWatch {
 public:
  LidarWatch(LidarProtocol protocol, std::uint32_t address);

  /// Takes a packet of points, of inertial samples or of position. Returns whether it is one of the LiDAR's protocol.
  bool take_data(const Arrival& arrival, sensor::PointBlock& scratch);

  /// Counts a datagram of this LiDAR's that nobody understands.
  void refuse() { ++seen_.refused; }

  void take(const livox::Sdk1Broadcast& broadcast, Stamp now);
  void take(const livox::Sdk2Discovery& answer, Stamp now);

  /// Takes what an SDK2 device answers to a question, or pushes.
  void take(livox::Sdk2ValueReader values);

  void end_second();

  LidarProtocol protocol() const { return seen_.protocol; }
  std::uint32_t address() const { return seen_.address; }

  /// Where an SDK2 device takes commands; port 0: it has not said.
  livox::Endpoint commands() const { return {seen_.address, command_port_}; }

  LidarSeen seen(Stamp now) const;

 private:
  bool take_velodyne(const Arrival& arrival, sensor::PointBlock& scratch);
  bool take_sdk1(const Arrival& arrival, sensor::PointBlock& scratch);
  bool take_sdk2(const Arrival& arrival, sensor::PointBlock& scratch);
  bool take_livox(livox::DecodeResult result, const Arrival& arrival, const livox::ImuReading& reading,
                  const sensor::PointBlock& block);
  void announce(const livox::DeviceCode& code, Stamp now);

  LidarSeen seen_;
  Stamp announced_{};
  std::uint16_t command_port_ = 0;
  SecondCount broadcasts_;
  SecondCount packets_;
  SecondCount points_;
  SecondCount positions_;
  bool has_imu_ = false;
  InertialWatch imu_;
  std::unique_ptr<velodyne::Decoder> velodyne_;
  std::unique_ptr<livox::LivoxDecoder> sdk1_;
  std::unique_ptr<livox::Sdk2Decoder> sdk2_;
};

}  // namespace slamd::sensors
