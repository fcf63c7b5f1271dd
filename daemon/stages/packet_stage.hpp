#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/sensor/clock_model.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/scan_assembler.hpp"
#include "daemon/configuration/configuration.hpp"
#include "drivers/livox/livox_decoder.hpp"
#include "drivers/recording/packet.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "drivers/velodyne/position.hpp"

namespace slamd::stages {

/// What a packet has brought.
struct PacketOutcome {
  const sensor::Scan* scan = nullptr;       // completed by this packet; valid until the next one completes
  std::optional<sensor::ImuSample> imu;     // from a built-in inertial sensor
};

/// Named counts, as reports show them.
using NamedCounts = std::vector<std::pair<std::string, std::uint64_t>>;

/// The receive stage of one LiDAR: packets to blocks on the time base to scans, by the model's decoder, its
/// ClockModel and the ScanAssembler.
///
/// Every packet is accounted for: data, position, inertial, foreign (another port), or refused by a named reason.
/// Real-time: add() allocates nothing; receive thread only.
class PacketStage {
 public:
  explicit PacketStage(const configuration::Configuration& configuration);

  PacketOutcome add(const recording::Packet& packet);

  /// Returns the unfinished scan at the end of a recording, or nullptr.
  const sensor::Scan* flush() { return assembler_.flush(); }

  /// Returns the packets by what became of them; the sum is what add() was given.
  NamedCounts packets() const;

  /// Returns what happened to the blocks that the assembler did not take, and to its scans.
  NamedCounts blocks() const;

  /// Says in words what is odd about the device, a line each.
  std::vector<std::string> remarks() const;

  const sensor::ClockHealth& clock() const { return clock_.health(); }
  const sensor::ScanAssemblerCounts& scans() const { return assembler_.counts(); }

 private:
  PacketOutcome add_velodyne(const recording::Packet& packet);
  PacketOutcome add_livox(const recording::Packet& packet);
  const sensor::Scan* assemble();

  bool livox_;
  bool takes_imu_;
  int port_;
  int position_port_;
  velodyne::Decoder velodyne_;
  livox::LivoxDecoder livox_decoder_;
  sensor::ClockModel clock_;
  sensor::ScanAssembler assembler_;
  sensor::PointBlock block_;      // scratch
  livox::ImuReading imu_reading_;  // scratch
  velodyne::Position position_;   // the last one
  std::uint64_t foreign_ = 0;
  std::uint64_t positions_ = 0;
  std::uint64_t positions_refused_ = 0;
};

}  // namespace slamd::stages
