#include "drivers/livox/sdk2_decoder.hpp"

#include <algorithm>
#include <limits>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "core/base/units.hpp"
#include "drivers/livox/control_frame.hpp"

namespace slamd::livox {

namespace {

constexpr std::size_t kShortestSdk2ControlFrame = 24;
constexpr std::uint8_t kSdk2ImuDataType = 0;
constexpr std::uint64_t kLatest_ns = std::numeric_limits<std::int64_t>::max();
constexpr std::uint8_t kFirstReturn = 1 << 4;  // SDK1's return number
/// A step beyond half the numbers is one backwards: a restart, or packets that changed places.
constexpr std::uint16_t kLongestGap = 0x7FFF;

}  // namespace

/// How the points of one data type lie in the packet. Source: livox-sdk2.md §4.
struct Sdk2Decoder::Layout {
  enum class Kind : std::uint8_t { kMillimetres, kCentimetres, kSpherical };

  Kind kind;
  std::size_t echoes;
  std::size_t return_bytes;

  static std::optional<Layout> of(std::uint8_t data_type) {
    switch (data_type) {
      case 0x01:
        return Layout{Kind::kMillimetres, 1, 14};
      case 0x02:
        return Layout{Kind::kCentimetres, 1, 8};
      case 0x03:
        return Layout{Kind::kSpherical, 1, 10};
      case 0x11:
        return Layout{Kind::kMillimetres, 2, 14};
      default:
        return std::nullopt;
    }
  }

  bool fits(std::size_t firings, std::size_t bytes) const {
    return firings > 0 && firings * echoes <= sensor::PointBlock::kMaxPoints &&
           bytes == firings * echoes * return_bytes;
  }
};

std::uint8_t tag_from_sdk2(std::uint8_t tag) {
  constexpr unsigned kMedium = 1;
  constexpr unsigned kLow = 2;
  const unsigned other = tag >> 4 & 3U;
  const unsigned weather = tag >> 2 & 3U;
  const unsigned between_objects = tag & 3U;
  const auto any_is = [&](unsigned confidence) {
    return other == confidence || weather == confidence;
  };
  const unsigned intensity_noise = any_is(kLow) ? 1U : (any_is(kMedium) ? 2U : 0U);
  const unsigned spatial_noise = between_objects == kLow ? 1U : (between_objects == kMedium ? 3U : 0U);
  return static_cast<std::uint8_t>(intensity_noise << 2 | spatial_noise);
}

Sdk2Decoder::Sdk2Decoder(const Sdk2Config& config) : config_(config) {
  SLAMD_ASSERT(config.firings_per_second >= 1000 && config.lines > 0);
  SLAMD_ASSERT(config.min_range_m < config.max_range_m);
}

DecodeResult Sdk2Decoder::decode(std::span<const std::byte> payload,
                                 Stamp received,
                                 sensor::PointBlock& block,
                                 ImuReading& imu) {
  const DecodeResult result = decode_checked(payload, received, block, imu);
  ++counters_.decoded.packets[static_cast<std::size_t>(result)];
  return result;
}

DecodeResult Sdk2Decoder::decode_checked(std::span<const std::byte> payload,
                                         Stamp received,
                                         sensor::PointBlock& block,
                                         ImuReading& imu) {
  if (begins_as_control_frame(payload, kShortestSdk2ControlFrame)) {
    return DecodeResult::kControlFrame;
  }
  if (payload.size() < Sdk2Header::kBytes) {
    return DecodeResult::kTooShort;
  }
  const Sdk2Header header = parse_sdk2_header(payload);
  if (header.version != Sdk2Header::kVersion) {
    return DecodeResult::kUnknownVersion;
  }
  if (header.length != payload.size()) {
    return DecodeResult::kWrongLength;
  }
  if (header.checksum != 0 && header.checksum != sdk2_checksum(payload)) {
    return DecodeResult::kBadChecksum;
  }
  const std::optional<Layout> layout = Layout::of(header.data_type);
  if (!layout && header.data_type != kSdk2ImuDataType) {
    return DecodeResult::kUnknownDataType;
  }
  const std::span<const std::byte> body = payload.subspan(Sdk2Header::kBytes);
  if (layout ? !layout->fits(header.points, body.size()) : body.size() != kImuBytes) {
    return DecodeResult::kWrongLength;
  }
  if (!sdk2_time_type_of(header.time_type)) {
    return DecodeResult::kBadTimestampType;
  }
  if (header.timestamp_ns >= kLatest_ns) {
    return DecodeResult::kBadTimestamp;
  }
  const DeviceStamp stamp{Duration{static_cast<std::int64_t>(header.timestamp_ns)}};
  if (layout) {
    block.device_stamp = stamp;
    block.received = received;
    decode_points(*layout, header, body, block);
  } else {
    ImuReading reading{stamp, received};
    if (!read_imu(body, reading)) {
      return DecodeResult::kBadImu;
    }
    imu = reading;
  }
  counters_.without_checksum += header.checksum == 0 ? 1 : 0;
  note_number(header);
  last_header_ = header;
  return layout ? DecodeResult::kPoints : DecodeResult::kImu;
}

void Sdk2Decoder::decode_points(const Layout& layout,
                                const Sdk2Header& header,
                                std::span<const std::byte> bytes,
                                sensor::PointBlock& block) {
  block.stamp = Stamp{};
  block.duration = Duration{offset_ns(header, header.points)};
  block.empty_firings = 0;
  block.points.clear();
  block.sequences.clear();
  for (std::size_t i = 0; i < header.points; ++i) {
    sensor::Point point;
    point.offset_ns = offset_ns(header, i);
    point.line = static_cast<std::uint8_t>(i % config_.lines);
    bool any_return = false;
    for (std::size_t echo = 0; echo < layout.echoes; ++echo) {
      const std::size_t at = (i * layout.echoes + echo) * layout.return_bytes;
      point.echo = static_cast<std::uint8_t>(echo);
      any_return |= decode_return(layout, bytes.subspan(at, layout.return_bytes), point, block);
    }
    block.empty_firings += any_return ? 0 : 1;
  }
  counters_.decoded.points += block.points.size();
  counters_.decoded.empty_firings += block.empty_firings;
}

/// Tells whether there was a return at all; it may have been taken out and counted.
bool Sdk2Decoder::decode_return(const Layout& layout,
                                std::span<const std::byte> bytes,
                                sensor::Point point,
                                sensor::PointBlock& block) {
  std::array<double, 3> p_lidar_m{};
  if (layout.kind == Layout::Kind::kSpherical) {
    const double depth_m = load_le<std::uint32_t>(bytes, 0) * 1e-3;
    const Direction direction{load_le<std::uint16_t>(bytes, 4), load_le<std::uint16_t>(bytes, 6)};
    if (depth_m == 0.0) {
      return false;
    }
    if (!direction.valid()) {
      ++counters_.decoded.bad_angles;
      return true;
    }
    const std::array<double, 3> unit = direction.unit_vector();
    p_lidar_m = {depth_m * unit[0], depth_m * unit[1], depth_m * unit[2]};
  } else if (layout.kind == Layout::Kind::kCentimetres) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p_lidar_m[axis] = load_le<std::int16_t>(bytes, 2 * axis) * 1e-2;
    }
  } else {
    const std::array<std::int32_t, 3> xyz_mm = load_xyz_mm(bytes);
    p_lidar_m = {xyz_mm[0] * 1e-3, xyz_mm[1] * 1e-3, xyz_mm[2] * 1e-3};
  }
  if (p_lidar_m == std::array<double, 3>{}) {
    return false;
  }
  const std::size_t rest = layout.return_bytes - 2;
  point.intensity = load_le<std::uint8_t>(bytes, rest);
  point.tag = tag_from_sdk2(load_le<std::uint8_t>(bytes, rest + 1));
  if (layout.echoes > 1) {
    point.tag = static_cast<std::uint8_t>(point.tag | kFirstReturn << point.echo);
  }
  const RangeGate gate{config_.min_range_m, config_.max_range_m};
  counters_.decoded.out_of_range += append_within(gate, p_lidar_m, point, block) ? 0 : 1;
  return true;
}

void Sdk2Decoder::note_number(const Sdk2Header& header) {
  const bool imu = header.data_type == kSdk2ImuDataType;
  std::optional<std::uint16_t>& last = imu ? last_imu_number_ : last_points_number_;
  if (last) {
    const auto missing = static_cast<std::uint16_t>(header.number - *last - 1);
    (imu ? counters_.imu_packets_missing : counters_.points_packets_missing) +=
        missing <= kLongestGap ? missing : 0;
  }
  last = header.number;
}

std::uint32_t Sdk2Decoder::offset_ns(const Sdk2Header& header, std::size_t firing) const {
  const std::uint64_t interval_ns = std::uint64_t{header.time_interval_100ns} * 100;
  const std::uint64_t steps =
      config_.interval == Sdk2Interval::kFirstToLast ? header.points - 1U : header.points;
  if (interval_ns == 0 || steps == 0) {
    const std::uint64_t rate = config_.firings_per_second;
    return static_cast<std::uint32_t>((firing * kNanosecondsPerSecond + rate / 2) / rate);
  }
  return static_cast<std::uint32_t>((firing * interval_ns + steps / 2) / steps);
}

}  // namespace slamd::livox
