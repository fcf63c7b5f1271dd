#include "tools/sensors/lidar_watch.hpp"

#include "drivers/velodyne/position.hpp"

namespace slamd::sensors {

using configuration::LidarModel;

namespace {

constexpr std::uint8_t kAviaType = 7;
constexpr std::uint8_t kMid360Type = 9;

/// Source: livox-sdk1.md §3.1.
std::string sdk1_type(std::uint8_t type) {
  switch (type) {
    case 0: return "Livox Hub";
    case 1: return "Livox Mid-40";
    case 2: return "Livox Tele-15";
    case 3: return "Livox Horizon";
    case 6: return "Livox Mid-70";
    case kAviaType: return "Livox Avia";
    default: return "Livox of type " + std::to_string(type) + " (SDK1)";
  }
}

/// Source: livox-sdk2.md §3.
std::string sdk2_type(std::uint8_t type) {
  switch (type) {
    case kMid360Type: return "Livox Mid-360";
    case 10:
    case 15: return "Livox HAP";
    case 35: return "Livox Mid-360s";
    case 40: return "Livox Avia 2";
    default: return "Livox of type " + std::to_string(type) + " (SDK2)";
  }
}

LidarModel model_of(velodyne::Model model) {
  switch (model) {
    case velodyne::Model::kVlp16: return LidarModel::kVlp16;
    case velodyne::Model::kVlp16HiRes: return LidarModel::kVlp16HiRes;
    case velodyne::Model::kVlp32c: return LidarModel::kVlp32c;
    case velodyne::Model::kHdl32e: break;
  }
  return LidarModel::kHdl32e;
}

const char* words_of(velodyne::Model model) {
  switch (model) {
    case velodyne::Model::kVlp16: return "Velodyne VLP-16";
    case velodyne::Model::kVlp16HiRes: return "Velodyne Puck Hi-Res";
    case velodyne::Model::kVlp32c: return "Velodyne VLP-32C";
    case velodyne::Model::kHdl32e: break;
  }
  return "Velodyne HDL-32E";
}

TimeSource source_of(livox::TimestampType type) {
  switch (type) {
    case livox::TimestampType::kPtp: return TimeSource::kPtp;
    case livox::TimestampType::kGps: return TimeSource::kGps;
    case livox::TimestampType::kPps: return TimeSource::kPps;
    case livox::TimestampType::kFreeRunning: break;
  }
  return TimeSource::kFreeRunning;
}

TimeSource source_of_sdk2(std::uint8_t type) {
  switch (type) {
    case 0: return TimeSource::kFreeRunning;
    case 1: return TimeSource::kPtp;
    case 2: return TimeSource::kGps;
    default: return TimeSource::kUnknown;
  }
}

}  // namespace

LidarWatch::LidarWatch(LidarProtocol protocol, std::uint32_t address) {
  seen_.protocol = protocol;
  seen_.address = address;
  switch (protocol) {
    case LidarProtocol::kVelodyne:
      seen_.type = "Velodyne";
      velodyne_ = std::make_unique<velodyne::Decoder>(velodyne::DecoderConfig{});
      break;
    case LidarProtocol::kSdk1:
      seen_.type = "Livox (SDK1)";
      sdk1_ = std::make_unique<livox::LivoxDecoder>(livox::LivoxConfig{});
      break;
    case LidarProtocol::kSdk2:
      seen_.type = "Livox (SDK2)";
      sdk2_ = std::make_unique<livox::Sdk2Decoder>(livox::Sdk2Config{});
      break;
  }
}

bool LidarWatch::take_data(const Arrival& arrival, sensor::PointBlock& scratch) {
  switch (seen_.protocol) {
    case LidarProtocol::kVelodyne: return take_velodyne(arrival, scratch);
    case LidarProtocol::kSdk1: return take_sdk1(arrival, scratch);
    case LidarProtocol::kSdk2: break;
  }
  return take_sdk2(arrival, scratch);
}

bool LidarWatch::take_velodyne(const Arrival& arrival, sensor::PointBlock& scratch) {
  velodyne::Position position;
  if (decode_position(arrival.payload, position) == velodyne::PositionResult::kOk &&
      (position.text().empty() || position.text().front() == '$')) {
    positions_.add();
    seen_.pps = position.pps;
    seen_.sentence = printable(std::string(position.text()));
    return true;
  }
  if (velodyne_->decode(arrival.payload, arrival.received, scratch) != velodyne::DecodeResult::kOk) {
    return false;
  }
  if (const auto model = velodyne::model_of_product(velodyne_->report().last_product)) {
    seen_.model = model_of(*model);
    seen_.type = words_of(*model);
  }
  packets_.add();
  points_.add(scratch.points.size());
  seen_.port = arrival.port;
  return true;
}

bool LidarWatch::take_sdk1(const Arrival& arrival, sensor::PointBlock& scratch) {
  livox::ImuReading reading;
  const livox::DecodeResult result = sdk1_->decode(arrival.payload, arrival.received, scratch, reading);
  if (!take_livox(result, arrival, reading, scratch)) {
    return false;
  }
  seen_.status = sdk1_->last_status();
  if (const auto type = livox::timestamp_type_of(sdk1_->last_header().timestamp_type)) {
    seen_.time = source_of(*type);
  }
  return true;
}

bool LidarWatch::take_sdk2(const Arrival& arrival, sensor::PointBlock& scratch) {
  livox::ImuReading reading;
  const livox::DecodeResult result = sdk2_->decode(arrival.payload, arrival.received, scratch, reading);
  if (!take_livox(result, arrival, reading, scratch)) {
    return false;
  }
  seen_.time = source_of_sdk2(sdk2_->last_header().time_type);
  return true;
}

bool LidarWatch::take_livox(livox::DecodeResult result, const Arrival& arrival, const livox::ImuReading& reading,
                            const sensor::PointBlock& block) {
  if (result == livox::DecodeResult::kPoints) {
    packets_.add();
    points_.add(block.points.size());
    seen_.port = arrival.port;
    return true;
  }
  if (result == livox::DecodeResult::kImu) {
    has_imu_ = true;
    imu_.add(reading);
    return true;
  }
  return false;
}

void LidarWatch::announce(const livox::DeviceCode& code, Stamp now) {
  broadcasts_.add();
  announced_ = now;
  seen_.code = printable(std::string(code.view()));
}

void LidarWatch::take(const livox::Sdk1Broadcast& broadcast, Stamp now) {
  announce(broadcast.code, now);
  seen_.type = sdk1_type(broadcast.device_type);
  seen_.model.reset();
  if (broadcast.device_type == kAviaType) {
    seen_.model = LidarModel::kLivoxAvia;
  }
}

void LidarWatch::take(const livox::Sdk2Discovery& answer, Stamp now) {
  announce(answer.serial_number, now);
  command_port_ = answer.command_port;
  seen_.type = sdk2_type(answer.device_type);
  seen_.model.reset();
  if (answer.device_type == kMid360Type) {
    seen_.model = LidarModel::kLivoxMid360;
  }
}

void LidarWatch::take(livox::Sdk2ValueReader values) {
  livox::Sdk2Value value;
  while (values.next(value)) {
    switch (value.key) {
      case livox::Sdk2Key::kPointDestination:
        if (const auto destination = livox::Sdk2Destination::parse(value.bytes)) {
          seen_.sends_to = destination->host_address;
        }
        break;
      case livox::Sdk2Key::kWorkState: seen_.work_state = value.as_u8(); break;
      case livox::Sdk2Key::kSyncType:
        if (const auto type = value.as_u8()) {
          seen_.time = source_of_sdk2(*type);
        }
        break;
      case livox::Sdk2Key::kHealth: seen_.health_code = livox::first_health_code(value.bytes); break;
      default: break;
    }
  }
}

void LidarWatch::end_second() {
  for (SecondCount* count : {&broadcasts_, &packets_, &points_, &positions_}) {
    count->end_second();
  }
  imu_.end_second();
}

LidarSeen LidarWatch::seen(Stamp now) const {
  LidarSeen seen = seen_;
  seen.broadcasts = broadcasts_.count();
  seen.silent_s = seen.broadcasts.total == 0 ? 0.0 : to_seconds(now - announced_);
  seen.packets = packets_.count();
  seen.points = points_.count();
  seen.positions = positions_.count();
  if (has_imu_) {
    seen.imu = imu_.seen();
  }
  return seen;
}

}  // namespace slamd::sensors
