#include "daemon/stages/packet_stage.hpp"

namespace slamd::stages {

using configuration::Configuration;
using configuration::LidarModel;
using configuration::SensorClock;

namespace {

constexpr int kVelodynePort = 2368;
constexpr Duration kHour = std::chrono::hours(1);

std::optional<velodyne::Model> velodyne_model(LidarModel model) {
  switch (model) {
    case LidarModel::kVlp16: return velodyne::Model::kVlp16;
    case LidarModel::kVlp16HiRes: return velodyne::Model::kVlp16HiRes;
    case LidarModel::kVlp32c: return velodyne::Model::kVlp32c;
    case LidarModel::kHdl32e: return velodyne::Model::kHdl32e;
    default: return std::nullopt;
  }
}

sensor::ClockConfig clock_config(const Configuration& configuration, bool livox) {
  sensor::ClockConfig config;
  config.kind = configuration.lidar.clock == SensorClock::kShared ? sensor::ClockKind::kShared
                                                                  : sensor::ClockKind::kEstimated;
  config.roll_over = livox ? Duration{} : kHour;
  return config;
}

std::string hex(std::uint8_t value) {
  const char* digits = "0123456789abcdef";
  return std::string("0x") + digits[value >> 4] + digits[value & 15];
}

}  // namespace

sensor::ScanAssemblerConfig assembler_config(const Configuration& configuration) {
  sensor::ScanAssemblerConfig config;
  config.rule = is_livox(configuration.lidar.model) ? sensor::CutRule::kPeriod : sensor::CutRule::kAzimuth;
  config.cut_azimuth_deg = configuration.lidar.cut_azimuth_deg;
  config.period = configuration.lidar.scan_period;
  config.max_points = configuration.odometry.preprocess.max_points;
  return config;
}

NamedCounts named_counts(const sensor::ScanAssemblerCounts& scans) {
  NamedCounts counts;
  counts.emplace_back("accepted", scans.blocks_accepted);
  for (std::size_t i = 0; i < sensor::kBlockRefusals; ++i) {
    const auto reason = static_cast<sensor::BlockRefusal>(i);
    counts.emplace_back("refused_" + std::string(sensor::to_string(reason)), scans.refused_for(reason));
  }
  counts.emplace_back("missing", scans.blocks_missing);
  return counts;
}

PacketStage::PacketStage(const Configuration& configuration)
    : livox_(is_livox(configuration.lidar.model)),
      sdk2_(configuration.lidar.model == LidarModel::kLivoxMid360),
      takes_imu_(configuration.imu.enabled && configuration.imu.source == "livox"),
      takes_gnss_(configuration.gnss.is_velodyne()),
      port_(configuration.lidar.port == 0 && !livox_ ? kVelodynePort : configuration.lidar.port),
      position_port_(configuration.lidar.position_port),
      imu_port_(sdk2_ ? configuration.lidar.imu_port : port_),
      velodyne_({velodyne_model(configuration.lidar.model), configuration.lidar.vertical_parallax}),
      livox_decoder_(livox::LivoxConfig{}),
      sdk2_decoder_(livox::Sdk2Config{}),
      clock_(clock_config(configuration, livox_)) {}

PacketOutcome PacketStage::add(const recording::Packet& packet, sensor::PointBlock& block) {
  return livox_ ? add_livox(packet, block) : add_velodyne(packet, block);
}

/// An Avia's packets say each for itself what their stamps count from: a PPS that comes or goes changes it.
void PacketStage::follow_timestamp_type() {
  if (livox_ && !sdk2_) {
    const bool pps = livox_decoder_.last_header().timestamp_type == static_cast<std::uint8_t>(livox::TimestampType::kPps);
    clock_.set_roll_over(pps ? livox::kPpsRollOver : Duration{});
  }
}

void PacketStage::stamp(sensor::PointBlock& block) {
  // A packet leaves when its last firing is done: that, not its first, is what latency counts from.
  block.stamp = clock_.map(block.device_stamp, block.received - block.duration);
}

PacketOutcome PacketStage::add_velodyne(const recording::Packet& packet, sensor::PointBlock& block) {
  PacketOutcome outcome;
  if (packet.destination_port == position_port_ && position_port_ != port_) {
    velodyne::Position position;
    if (velodyne::decode_position(packet.payload, position) == velodyne::PositionResult::kOk) {
      position_ = position;
      ++positions_;
      if (takes_gnss_) {
        gnss_.add_sentence(position.text(), packet.received);
      }
      outcome.is_position = true;
    } else {
      ++positions_refused_;
    }
  } else if (packet.destination_port != port_) {
    ++foreign_;
  } else if (velodyne_.decode(packet.payload, packet.received, block) == velodyne::DecodeResult::kOk) {
    stamp(block);
    outcome.has_block = true;
  }
  return outcome;
}

livox::DecodeResult PacketStage::decode_livox(const recording::Packet& packet, sensor::PointBlock& block) {
  return sdk2_ ? sdk2_decoder_.decode(packet.payload, packet.received, block, imu_reading_)
               : livox_decoder_.decode(packet.payload, packet.received, block, imu_reading_);
}

const livox::LivoxCounters& PacketStage::livox_counters() const {
  return sdk2_ ? sdk2_decoder_.counters().decoded : livox_decoder_.counters();
}

PacketOutcome PacketStage::add_livox(const recording::Packet& packet, sensor::PointBlock& block) {
  PacketOutcome outcome;
  if (port_ != 0 && packet.destination_port != port_ && packet.destination_port != imu_port_) {
    ++foreign_;
    return outcome;
  }
  const livox::DecodeResult result = decode_livox(packet, block);
  follow_timestamp_type();
  switch (result) {
    case livox::DecodeResult::kPoints:
      stamp(block);
      outcome.has_block = true;
      break;
    case livox::DecodeResult::kImu:
      if (takes_imu_) {
        outcome.imu = sensor::ImuSample{clock_.map(imu_reading_.device_stamp, packet.received),
                                        imu_reading_.angular_rate_radps,
                                        imu_reading_.specific_force_mps2};
      }
      break;
    default:
      break;  // counted by the decoder
  }
  return outcome;
}

NamedCounts PacketStage::packets() const {
  NamedCounts counts;
  const auto add_if = [&](const std::string& name, std::uint64_t count, bool always) {
    if (always || count != 0) {
      counts.emplace_back(name, count);
    }
  };
  if (livox_) {
    for (std::size_t i = 0; i < livox::kDecodeResults; ++i) {
      const auto result = static_cast<livox::DecodeResult>(i);
      const bool good = result == livox::DecodeResult::kPoints || result == livox::DecodeResult::kImu;
      add_if((good ? "" : "refused_") + std::string(livox::name_of(result)), livox_counters().of(result), good);
    }
  } else {
    for (std::size_t i = 0; i < velodyne::kDecodeResults; ++i) {
      const auto result = static_cast<velodyne::DecodeResult>(i);
      const bool good = result == velodyne::DecodeResult::kOk;
      add_if(good ? "data" : std::string("refused_") + velodyne::name_of(result), velodyne_.report().of(result), good);
    }
    add_if("position", positions_, true);
    add_if("refused_position", positions_refused_, false);
  }
  add_if("foreign_port", foreign_, true);
  return counts;
}

std::vector<std::string> PacketStage::remarks() const {
  std::vector<std::string> lines;
  if (velodyne_.report().other_product != 0) {
    lines.push_back("odd firmware: " + std::to_string(velodyne_.report().other_product) +
                    " packets carry product byte " + hex(velodyne_.report().last_product) +
                    ", which is not the configured model's");
  }
  if (positions_ != 0 && position_.sentence.empty()) {
    lines.emplace_back("position packets carry no NMEA sentence: the sensor hears no GNSS");
  }
  if (foreign_ != 0) {
    lines.push_back(std::to_string(foreign_) + " packets went to other ports than the sensor's (" +
                    std::to_string(port_) + ")");
  }
  if (const livox::Sdk2Counters& sdk2 = sdk2_decoder_.counters(); sdk2_) {
    const std::uint64_t missing = sdk2.points_packets_missing + sdk2.imu_packets_missing;
    if (missing != 0) {
      lines.push_back("by their own numbers, " + std::to_string(sdk2.points_packets_missing) + " packets of points and " +
                      std::to_string(sdk2.imu_packets_missing) + " of the inertial sensor are missing");
    }
    if (sdk2.without_checksum != 0) {
      lines.push_back(std::to_string(sdk2.without_checksum) + " packets came without a checksum");
    }
  }
  if (clock_.health().steps != 0) {
    lines.push_back("the sensor's clock jumped " + std::to_string(clock_.health().steps) + " times");
  }
  if (clock_.health().taken_off != Duration{}) {
    lines.push_back("the sensor's clock is no longer the shared one: it is ahead by " +
                    std::to_string(to_seconds(clock_.health().taken_off)) + " s, which is taken off");
  }
  return lines;
}

}  // namespace slamd::stages
