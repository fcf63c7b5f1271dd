#include "drivers/imu/xsens.hpp"

#include <bit>
#include <cmath>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"

namespace slamd::imu {

namespace {

constexpr std::uint8_t kPreamble = 0xFA;
constexpr std::uint8_t kDirect = 0xFF;  // the bus address of a device on a line of its own
constexpr std::uint8_t kExtended = 0xFF;
constexpr std::size_t kShortHeader = 4;
constexpr std::size_t kLongHeader = 6;
constexpr std::size_t kLongestData = 2048;

constexpr std::uint16_t kTypeBits = 0xF8F0;
constexpr std::uint16_t kFormatBits = 0x0003;
constexpr std::uint16_t kAccelerationHighRate = 0x4040;
constexpr std::uint16_t kRateOfTurnHighRate = 0x8040;
constexpr std::uint32_t kClipping = 1U << 19;
constexpr Duration kTick = std::chrono::microseconds{100};

/// What a number of each format takes.
constexpr std::size_t kNumberBytes[] = {4, 4, 6, 8};

/// Writes what number_at() reads.
void store_number(std::span<std::byte> data, std::size_t at, std::uint8_t format, double value) {
  switch (format) {
    case 0:
      store_be(data, at, static_cast<float>(value));
      break;
    case 1:
      store_be(data, at, static_cast<std::int32_t>(std::llround(value * 1048576.0)));
      break;
    case 2: {
      const auto fixed = static_cast<std::int64_t>(std::llround(value * 4294967296.0));
      store_be(data, at, static_cast<std::uint32_t>(fixed & 0xFFFFFFFF));
      store_be(data, at + 4, static_cast<std::int16_t>(fixed >> 32));
      break;
    }
    default:
      store_be(data, at, value);
      break;
  }
}

double number_at(std::span<const std::byte> data, std::size_t at, std::uint8_t format) {
  switch (format) {
    case 0:
      return load_be<float>(data, at);
    case 1:
      return load_be<std::int32_t>(data, at) / 1048576.0;
    case 2:  // the fraction comes first
      return load_be<std::int16_t>(data, at + 4) + load_be<std::uint32_t>(data, at) / 4294967296.0;
    default:
      return load_be<double>(data, at);
  }
}

std::uint8_t sum_of(std::span<const std::byte> bytes) {
  unsigned sum = 0;
  for (const std::byte byte : bytes) {
    sum += std::to_integer<unsigned>(byte);
  }
  return static_cast<std::uint8_t>(sum);
}

bool consists_of_items(std::span<const std::byte> data) {
  MtItems items(data);
  MtItem item;
  while (items.next(item)) {
  }
  return !items.malformed();
}

Eigen::Vector3d eigen(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

FrameView Xbus::inspect(std::span<const std::byte> bytes) {
  if (load_be<std::uint8_t>(bytes, 0) != kPreamble) {
    return {FrameVerdict::kNoFrame, 0};
  }
  // The checksum has 8 bits only, and a false frame swallows true ones: whatever else tells them apart is of use.
  if (bytes.size() > 1 && load_be<std::uint8_t>(bytes, 1) != kDirect) {
    return {FrameVerdict::kNoFrame, 0};
  }
  if (bytes.size() < kShortHeader) {
    return {FrameVerdict::kNeedsMore, 0};
  }
  std::size_t header = kShortHeader;
  std::size_t length = load_be<std::uint8_t>(bytes, 3);
  if (length == kExtended) {
    header = kLongHeader;
    if (bytes.size() < kLongHeader) {
      return {FrameVerdict::kNeedsMore, 0};
    }
    length = load_be<std::uint16_t>(bytes, 4);
    if (length > kLongestData) {
      return {FrameVerdict::kNoFrame, 0};
    }
  }
  const std::size_t size = header + length + 1;
  if (bytes.size() < size) {
    return {FrameVerdict::kNeedsMore, 0};
  }
  if (sum_of(bytes.subspan(1, size - 1)) != 0) {
    return {FrameVerdict::kDamaged, 0};
  }
  const bool data = load_be<std::uint8_t>(bytes, 2) == xbus::kMtData2;
  return data && !consists_of_items(bytes.subspan(header, length)) ? FrameView{FrameVerdict::kDamaged, 0}
                                                                   : FrameView{FrameVerdict::kFrame, size};
}

XbusMessage Xbus::parse(std::span<const std::byte> frame) {
  const std::size_t header = load_be<std::uint8_t>(frame, 3) == kExtended ? kLongHeader : kShortHeader;
  return {load_be<std::uint8_t>(frame, 2), frame.subspan(header, frame.size() - header - 1)};
}

XbusBytes write_xbus(const XbusMessage& message) {
  SLAMD_ASSERT(message.data.size() + kLongHeader + 1 <= XbusBytes::capacity());
  XbusBytes bytes;
  unsigned sum = 0;
  const auto put = [&](std::size_t value) {
    bytes.push_back(static_cast<std::byte>(value & 0xFFU));
    sum += static_cast<unsigned>(value & 0xFFU);
  };
  bytes.push_back(std::byte{kPreamble});
  put(kDirect);
  put(message.id);
  if (message.data.size() < kExtended) {
    put(message.data.size());
  } else {
    put(kExtended);
    put(message.data.size() >> 8);
    put(message.data.size());
  }
  for (const std::byte byte : message.data) {
    put(std::to_integer<std::size_t>(byte));
  }
  bytes.push_back(static_cast<std::byte>(0U - sum));
  return bytes;
}

XbusBytes write_output_configuration(std::span<const XsensOutput> outputs) {
  std::array<std::byte, 128> data{};
  SLAMD_ASSERT(4 * outputs.size() <= data.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    store_be<std::uint16_t>(data, 4 * i, outputs[i].data_id);
    store_be<std::uint16_t>(data, 4 * i + 2, outputs[i].rate_hz);
  }
  return write_xbus({xbus::kSetOutputConfiguration, std::span(data).first(4 * outputs.size())});
}

XbusBytes write_sample(std::span<const XsensOutput> outputs, const XsensSample& sample) {
  std::array<std::byte, 254> data{};
  std::size_t size = 0;
  const auto item = [&](std::uint16_t id, std::size_t bytes) {
    SLAMD_ASSERT(size + 3 + bytes <= data.size());
    store_be(data, size, id);
    store_be(data, size + 2, static_cast<std::uint8_t>(bytes));
    size += 3 + bytes;
    return size - bytes;
  };
  const auto vector = [&](std::uint16_t id, const Eigen::Vector3d& value) {
    const auto format = static_cast<std::uint8_t>(id & kFormatBits);
    const std::size_t bytes = kNumberBytes[format];
    const std::size_t at = item(id, 3 * bytes);
    for (Eigen::Index i = 0; i < 3; ++i) {
      store_number(data, at + static_cast<std::size_t>(i) * bytes, format, value[i]);
    }
  };
  for (const XsensOutput& output : outputs) {
    switch (output.data_id & kTypeBits) {
      case mt::kPacketCounter: store_be(data, item(output.data_id, 2), sample.count); break;
      case mt::kSampleTimeFine: store_be(data, item(output.data_id, 4), sample.ticks); break;
      case mt::kAcceleration: vector(output.data_id, sample.specific_force_mps2); break;
      case mt::kRateOfTurn: vector(output.data_id, sample.angular_rate_radps); break;
      case mt::kStatusWord: store_be(data, item(output.data_id, 4), sample.clipped ? kClipping : 0U); break;
      default: break;
    }
  }
  return write_xbus({xbus::kMtData2, std::span(data).first(size)});
}

std::optional<std::array<double, 3>> MtItem::as_vector() const {
  const std::size_t bytes = kNumberBytes[format];
  if (data.size() != 3 * bytes) {
    return std::nullopt;
  }
  return std::array<double, 3>{number_at(data, 0, format), number_at(data, bytes, format),
                               number_at(data, 2 * bytes, format)};
}

bool MtItems::next(MtItem& item) {
  if (rest_.empty() || malformed_) {
    return false;
  }
  if (rest_.size() < 3 || rest_.size() < 3U + load_be<std::uint8_t>(rest_, 2)) {
    malformed_ = true;
    return false;
  }
  const auto id = load_be<std::uint16_t>(rest_, 0);
  const std::size_t size = load_be<std::uint8_t>(rest_, 2);
  item.type = id & kTypeBits;
  item.format = static_cast<std::uint8_t>(id & kFormatBits);
  item.data = rest_.subspan(3, size);
  rest_ = rest_.subspan(3 + size);
  return true;
}

/// What a message may hold of a sample.
struct XsensReader::Contents {
  std::optional<std::array<double, 3>> force_mps2;
  std::optional<std::array<double, 3>> rate_radps;
  std::optional<std::uint32_t> ticks;
  std::optional<std::uint16_t> count;
  bool clipped = false;
  bool malformed = false;

  explicit Contents(std::span<const std::byte> data) {
    MtItems items(data);
    MtItem item;
    while (items.next(item)) {
      add(item);
    }
    malformed = malformed || items.malformed();
  }

  void add(const MtItem& item) {
    switch (item.type) {
      case mt::kAcceleration:
      case kAccelerationHighRate:
        force_mps2 = item.as_vector();
        malformed = malformed || !force_mps2;
        break;
      case mt::kRateOfTurn:
      case kRateOfTurnHighRate:
        rate_radps = item.as_vector();
        malformed = malformed || !rate_radps;
        break;
      case mt::kSampleTimeFine:
        malformed = malformed || item.data.size() != 4;
        if (item.data.size() == 4) {
          ticks = load_be<std::uint32_t>(item.data, 0);
        }
        break;
      case mt::kPacketCounter:
        malformed = malformed || item.data.size() != 2;
        if (item.data.size() == 2) {
          count = load_be<std::uint16_t>(item.data, 0);
        }
        break;
      case mt::kStatusWord:
        clipped = item.data.size() == 4 && (load_be<std::uint32_t>(item.data, 0) & kClipping) != 0;
        break;
      default:
        break;  // of no use here
    }
  }
};

InertialResult XsensReader::take(const XbusMessage& message, sensor::ImuReading& reading) {
  const InertialResult result = decode(message, reading);
  ++counters_.frames[static_cast<std::size_t>(result)];
  return result;
}

InertialResult XsensReader::decode(const XbusMessage& message, sensor::ImuReading& reading) {
  if (message.id == xbus::kError && message.data.size() == 1) {
    device_error_ = load_be<std::uint8_t>(message.data, 0);
  }
  if (message.id != xbus::kMtData2) {
    return InertialResult::kOther;
  }
  const Contents contents(message.data);
  if (contents.malformed) {
    return InertialResult::kMalformed;
  }
  // The counters go on with every message, inertial or not.
  const std::optional<DeviceStamp> stamp = stamp_of(contents);
  if (!contents.force_mps2 && !contents.rate_radps) {
    return InertialResult::kOther;
  }
  if (!contents.force_mps2 || !contents.rate_radps) {
    return InertialResult::kIncomplete;
  }
  if (!stamp) {
    return InertialResult::kNoTime;
  }
  reading.device_stamp = *stamp;
  reading.angular_rate_radps = eigen(*contents.rate_radps);
  reading.specific_force_mps2 = eigen(*contents.force_mps2);
  counters_.clipped += contents.clipped ? 1 : 0;
  return judge(reading);
}

std::optional<DeviceStamp> XsensReader::stamp_of(const Contents& contents) {
  if (contents.count) {
    if (last_count_) {
      const auto step = static_cast<std::uint16_t>(*contents.count - *last_count_);
      samples_ += step;
      counters_.missing += step > 1 && step < 0x8000 ? step - 1U : 0U;
    }
    last_count_ = contents.count;
  }
  if (contents.ticks) {
    // A step of more than half the range is one backwards: the device began anew.
    ticks_ += last_ticks_ ? std::bit_cast<std::int32_t>(*contents.ticks - *last_ticks_)
                          : std::int64_t{*contents.ticks};
    last_ticks_ = contents.ticks;
    return DeviceStamp{ticks_ * kTick};
  }
  if (contents.count && period_ > Duration::zero()) {
    return DeviceStamp{samples_ * period_};
  }
  return std::nullopt;
}

}  // namespace slamd::imu
