#include "drivers/imu/mip.hpp"

#include <array>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "core/base/units.hpp"

namespace slamd::imu {

namespace {

constexpr std::uint16_t kSync = 0x7565;  // "ue"
constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kChecksumBytes = 2;

constexpr std::uint8_t kGpsTime = 0xD3;

constexpr std::uint64_t kLatest_ns = std::uint64_t{1} << 62;  // half the range: differences do not overflow
constexpr double kWeek_s = 604'800.0;
constexpr std::uint16_t kLatestWeek = 7'000;  // in the year 2114

std::uint16_t checksum_of(std::span<const std::byte> bytes) {
  unsigned a = 0;
  unsigned b = 0;
  for (const std::byte byte : bytes) {
    a = (a + std::to_integer<unsigned>(byte)) & 0xFFU;
    b = (b + a) & 0xFFU;
  }
  return static_cast<std::uint16_t>(a << 8 | b);
}

Eigen::Vector3d vector_at(std::span<const std::byte> data) {
  return {load_be<float>(data, 0), load_be<float>(data, 4), load_be<float>(data, 8)};
}

/// Time of week, week, flags: nothing for what no GPS tells.
std::optional<DeviceStamp> gps_time(std::span<const std::byte> data) {
  const auto in_week_s = load_be<double>(data, 0);
  const auto week = load_be<std::uint16_t>(data, 8);
  if (!(in_week_s >= 0.0 && in_week_s < kWeek_s) || week > kLatestWeek) {
    return std::nullopt;
  }
  const auto in_week_ns = static_cast<std::int64_t>(std::llround(in_week_s * 1e9));
  return DeviceStamp{std::chrono::hours{168} * week + Duration{in_week_ns}};
}

}  // namespace

FrameView Mip::inspect(std::span<const std::byte> bytes) {
  if (load_be<std::uint8_t>(bytes, 0) != kSync >> 8) {
    return {FrameVerdict::kNoFrame, 0};
  }
  if (bytes.size() > 1 && load_be<std::uint16_t>(bytes, 0) != kSync) {
    return {FrameVerdict::kNoFrame, 0};
  }
  if (bytes.size() < kHeaderBytes) {
    return {FrameVerdict::kNeedsMore, 0};
  }
  const std::size_t covered = kHeaderBytes + load_be<std::uint8_t>(bytes, 3);
  if (bytes.size() < covered + kChecksumBytes) {
    return {FrameVerdict::kNeedsMore, 0};
  }
  return checksum_of(bytes.first(covered)) == load_be<std::uint16_t>(bytes, covered)
             ? FrameView{FrameVerdict::kFrame, covered + kChecksumBytes}
             : FrameView{FrameVerdict::kDamaged, 0};
}

MipPacket Mip::parse(std::span<const std::byte> frame) {
  return {load_be<std::uint8_t>(frame, 2), frame.subspan(kHeaderBytes, frame.size() - kHeaderBytes - kChecksumBytes)};
}

MipBytes write_mip(const MipPacket& packet) {
  SLAMD_ASSERT(packet.payload.size() <= 255);
  MipBytes bytes;
  bytes.push_back(static_cast<std::byte>(kSync >> 8));
  bytes.push_back(static_cast<std::byte>(kSync & 0xFFU));
  bytes.push_back(static_cast<std::byte>(packet.set));
  bytes.push_back(static_cast<std::byte>(packet.payload.size()));
  for (const std::byte byte : packet.payload) {
    bytes.push_back(byte);
  }
  const std::uint16_t checksum = checksum_of(bytes.view());
  bytes.push_back(static_cast<std::byte>(checksum >> 8));
  bytes.push_back(static_cast<std::byte>(checksum & 0xFFU));
  return bytes;
}

bool MipFields::next(MipField& field) {
  if (rest_.empty() || malformed_) {
    return false;
  }
  const std::size_t size = load_be<std::uint8_t>(rest_, 0);
  if (size < 2 || size > rest_.size()) {
    malformed_ = true;
    return false;
  }
  field.descriptor = load_be<std::uint8_t>(rest_, 1);
  field.data = rest_.subspan(2, size - 2);
  rest_ = rest_.subspan(size);
  return true;
}

MipBytes write_message_format(std::span<const MipOutput> outputs) {
  std::array<std::byte, 255> raw{};
  const std::size_t size = 5 + 3 * outputs.size();
  SLAMD_ASSERT(size <= raw.size());
  store_be<std::uint8_t>(raw, 0, static_cast<std::uint8_t>(size));
  store_be<std::uint8_t>(raw, 1, mip::kMessageFormat);
  store_be<std::uint8_t>(raw, 2, mip::kSet);
  store_be<std::uint8_t>(raw, 3, mip::kSensorData);
  store_be<std::uint8_t>(raw, 4, static_cast<std::uint8_t>(outputs.size()));
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    store_be<std::uint8_t>(raw, 5 + 3 * i, outputs[i].descriptor);
    store_be<std::uint16_t>(raw, 6 + 3 * i, outputs[i].decimation);
  }
  return write_mip({mip::kSensorCommands, std::span(raw).first(size)});
}

MipBytes write_sample(std::span<const MipOutput> outputs, const MipSample& sample) {
  std::array<std::byte, 255> payload{};
  std::size_t size = 0;
  const auto field = [&](std::uint8_t descriptor, std::size_t bytes) {
    SLAMD_ASSERT(size + 2 + bytes <= payload.size());
    store_be(payload, size, static_cast<std::uint8_t>(2 + bytes));
    store_be(payload, size + 1, descriptor);
    size += 2 + bytes;
    return size - bytes;
  };
  const auto vector = [&](std::uint8_t descriptor, const Eigen::Vector3d& value) {
    const std::size_t at = field(descriptor, 12);
    for (Eigen::Index i = 0; i < 3; ++i) {
      store_be(payload, at + 4 * static_cast<std::size_t>(i), static_cast<float>(value[i]));
    }
  };
  for (const MipOutput& output : outputs) {
    switch (output.descriptor) {
      case mip::kReferenceTime: store_be(payload, field(output.descriptor, 8), sample.reference_time_ns); break;
      case mip::kDeltaReferenceTime: store_be(payload, field(output.descriptor, 8), sample.since_last_ns); break;
      case mip::kAcceleration: vector(output.descriptor, sample.specific_force_mps2 / kStandardGravity_mps2); break;
      case mip::kTurnRate: vector(output.descriptor, sample.angular_rate_radps); break;
      case mip::kOverrange: store_be(payload, field(output.descriptor, 2), std::uint16_t{sample.clipped}); break;
      default: break;
    }
  }
  return write_mip({mip::kSensorData, std::span(payload).first(size)});
}

std::optional<MipAck> ack_of(const MipPacket& packet) {
  if (packet.set != mip::kBaseCommands && packet.set != mip::kSensorCommands) {
    return std::nullopt;
  }
  MipFields fields(packet.payload);
  MipField field;
  while (fields.next(field)) {
    if (field.descriptor == mip::kAckField && field.data.size() == 2) {
      return MipAck{load_be<std::uint8_t>(field.data, 0), load_be<std::uint8_t>(field.data, 1)};
    }
  }
  return std::nullopt;
}

/// What a packet may hold of a sample.
struct MipReader::Contents {
  std::optional<Eigen::Vector3d> force_g;
  std::optional<Eigen::Vector3d> rate_radps;
  std::optional<DeviceStamp> reference;
  std::optional<DeviceStamp> gps;
  std::optional<std::uint64_t> delta_ns;
  bool clipped = false;
  bool malformed = false;

  explicit Contents(std::span<const std::byte> payload) {
    MipFields fields(payload);
    MipField field;
    while (fields.next(field)) {
      add(field);
    }
    malformed = malformed || fields.malformed();
  }

  void add(const MipField& field) {
    const auto has = [&](std::size_t bytes) {
      malformed = malformed || field.data.size() != bytes;
      return field.data.size() == bytes;
    };
    switch (field.descriptor) {
      case mip::kAcceleration:
        if (has(12)) {
          force_g = vector_at(field.data);
        }
        break;
      case mip::kTurnRate:
        if (has(12)) {
          rate_radps = vector_at(field.data);
        }
        break;
      case mip::kReferenceTime:
        if (has(8) && load_be<std::uint64_t>(field.data, 0) < kLatest_ns) {
          reference = DeviceStamp{Duration{static_cast<std::int64_t>(load_be<std::uint64_t>(field.data, 0))}};
        }
        break;
      case mip::kDeltaReferenceTime:
        if (has(8)) {
          delta_ns = load_be<std::uint64_t>(field.data, 0);
        }
        break;
      case mip::kGpsTimestamp:
      case kGpsTime:
        if (has(12)) {
          gps = gps_time(field.data);
        }
        break;
      case mip::kOverrange:
        for (const std::byte byte : field.data) {
          clipped = clipped || byte != std::byte{0};
        }
        break;
      default:
        break;  // of no use here
    }
  }
};

InertialResult MipReader::take(const MipPacket& packet, sensor::ImuReading& reading) {
  const InertialResult result = decode(packet, reading);
  ++counters_.frames[static_cast<std::size_t>(result)];
  return result;
}

InertialResult MipReader::decode(const MipPacket& packet, sensor::ImuReading& reading) {
  if (const std::optional<MipAck> ack = ack_of(packet); ack && ack->code != 0) {
    refusal_ = ack;
  }
  if (packet.set != mip::kSensorData) {
    return InertialResult::kOther;
  }
  const Contents contents(packet.payload);
  if (contents.malformed) {
    return InertialResult::kMalformed;
  }
  if (!contents.force_g && !contents.rate_radps) {
    return InertialResult::kOther;
  }
  if (!contents.force_g || !contents.rate_radps) {
    return InertialResult::kIncomplete;
  }
  const std::optional<DeviceStamp> stamp = contents.reference ? contents.reference : contents.gps;
  if (!stamp) {
    return InertialResult::kNoTime;
  }
  reading.device_stamp = *stamp;
  reading.angular_rate_radps = *contents.rate_radps;
  reading.specific_force_mps2 = *contents.force_g * kStandardGravity_mps2;
  note_gap(*stamp, contents.delta_ns);
  counters_.clipped += contents.clipped ? 1 : 0;
  return judge(reading);
}

/// The device tells how long ago its last sample was, whether that has come or not.
void MipReader::note_gap(DeviceStamp stamp, std::optional<std::uint64_t> delta_ns) {
  constexpr std::int64_t kLongestGap_ns = 3'600'000'000'000;
  if (last_ && delta_ns && *delta_ns > 0 && *delta_ns < static_cast<std::uint64_t>(kLongestGap_ns)) {
    const std::int64_t since_ns = (stamp - *last_).count();
    const auto delta = static_cast<std::int64_t>(*delta_ns);
    if (since_ns > 0 && since_ns < kLongestGap_ns) {
      counters_.missing += static_cast<std::uint64_t>(std::max<std::int64_t>(0, (since_ns + delta / 2) / delta - 1));
    }
  }
  last_ = stamp;
}

}  // namespace slamd::imu
