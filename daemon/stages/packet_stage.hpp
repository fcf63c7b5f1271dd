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
#include "daemon/stages/gnss_stage.hpp"
#include "drivers/livox/livox_decoder.hpp"
#include "drivers/livox/sdk2_decoder.hpp"
#include "drivers/recording/packet.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "drivers/velodyne/position.hpp"

namespace slamd::stages {

/// What a packet has brought.
struct PacketOutcome {
  bool has_block = false;                   // the caller's block now holds its points
  bool is_position = false;                 // a good position packet of a Velodyne
  std::optional<sensor::ImuSample> imu;     // from a built-in inertial sensor
};

/// Named counts, as reports show them.
using NamedCounts = std::vector<std::pair<std::string, std::uint64_t>>;

/// Returns how a LiDAR's blocks are cut into scans.
sensor::ScanAssemblerConfig assembler_config(const configuration::Configuration& configuration);

/// Returns what happened to the blocks that an assembler did or did not take.
NamedCounts named_counts(const sensor::ScanAssemblerCounts& counts);

/// The receive stage of one LiDAR: packets to blocks on the time base, by the model's decoder and its ClockModel.
///
/// Every packet is accounted for: data, position, inertial, foreign (another port), or refused by a named reason.
/// Real-time: add() allocates nothing; receive thread only.
class PacketStage {
 public:
  explicit PacketStage(const configuration::Configuration& configuration);

  /// Decodes a packet; what `block` holds afterwards is valid only when the outcome says so.
  PacketOutcome add(const recording::Packet& packet, sensor::PointBlock& block);

  /// Returns the packets by what became of them; the sum is what add() was given.
  NamedCounts packets() const;

  /// Says in words what is odd about the device, a line each.
  std::vector<std::string> remarks() const;

  /// What the sentences of position packets say, where gnss.source wants them.
  const GnssStage& gnss_stage() const { return gnss_; }
  NamedCounts gnss_counts() const { return takes_gnss_ ? gnss_.counts() : NamedCounts{}; }

  const sensor::ClockHealth& clock() const { return clock_.health(); }

 private:
  PacketOutcome add_velodyne(const recording::Packet& packet, sensor::PointBlock& block);
  PacketOutcome add_livox(const recording::Packet& packet, sensor::PointBlock& block);
  livox::DecodeResult decode_livox(const recording::Packet& packet, sensor::PointBlock& block);
  const livox::LivoxCounters& livox_counters() const;
  void follow_timestamp_type();
  void stamp(sensor::PointBlock& block);

  bool livox_;
  bool sdk2_;  // which of the two that a Livox speaks
  bool takes_imu_;
  bool takes_gnss_;
  int port_;
  int position_port_;
  int imu_port_;
  velodyne::Decoder velodyne_;
  livox::LivoxDecoder livox_decoder_;
  livox::Sdk2Decoder sdk2_decoder_;
  sensor::ClockModel clock_;
  livox::ImuReading imu_reading_;  // scratch
  velodyne::Position position_;   // the last one
  GnssStage gnss_;
  std::uint64_t foreign_ = 0;
  std::uint64_t positions_ = 0;
  std::uint64_t positions_refused_ = 0;
};

}  // namespace slamd::stages
