#include "drivers/livox/livox_decoder.hpp"

#include <optional>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "core/base/units.hpp"
#include "drivers/livox/control_frame.hpp"
#include "drivers/livox/wire_return.hpp"

namespace slamd::livox {

namespace {

constexpr std::size_t kShortestControlFrame = 15;
constexpr std::uint8_t kImuDataType = 6;

/// One return as it is on the wire; which of the coordinates count, the layout says.
struct WireReturn {
  std::array<std::int32_t, 3> xyz_mm{};
  std::uint32_t depth_mm = 0;
  std::uint8_t reflectivity = 0;
  std::uint8_t tag = 0;
};

WireReturn cartesian_return(std::span<const std::byte> bytes, bool tagged) {
  WireReturn wire;
  wire.xyz_mm = load_xyz_mm(bytes);
  wire.reflectivity = load_le<std::uint8_t>(bytes, 12);
  wire.tag = tagged ? load_le<std::uint8_t>(bytes, 13) : std::uint8_t{0};
  return wire;
}

/// A lone return has its depth in front of the angles; several have the angles in front of all.
WireReturn spherical_return(std::span<const std::byte> firing,
                            std::size_t echo,
                            std::size_t echoes,
                            bool tagged) {
  const std::size_t depth_at = echoes == 1 ? 0 : 4 + 6 * echo;
  const std::size_t rest_at = echoes == 1 ? 8 : depth_at + 4;
  WireReturn wire;
  wire.depth_mm = load_le<std::uint32_t>(firing, depth_at);
  wire.reflectivity = load_le<std::uint8_t>(firing, rest_at);
  wire.tag = tagged ? load_le<std::uint8_t>(firing, rest_at + 1) : std::uint8_t{0};
  return wire;
}

Direction direction_of(std::span<const std::byte> firing, std::size_t echoes) {
  const std::size_t at = echoes == 1 ? 4 : 0;
  return {load_le<std::uint16_t>(firing, at), load_le<std::uint16_t>(firing, at + 2)};
}

}  // namespace

/// How the points of one data type lie in the packet. Source: livox-sdk1.md §5.3.
struct LivoxDecoder::Layout {
  bool spherical;
  bool tagged;
  std::size_t echoes;
  std::size_t firings;
  std::size_t firing_bytes;

  static std::optional<Layout> of(std::uint8_t data_type) {
    switch (data_type) {
      case 0:
        return Layout{false, false, 1, 100, 13};
      case 1:
        return Layout{true, false, 1, 100, 9};
      case 2:
        return Layout{false, true, 1, 96, 14};
      case 3:
        return Layout{true, true, 1, 96, 10};
      case 4:
        return Layout{false, true, 2, 48, 28};
      case 5:
        return Layout{true, true, 2, 48, 16};
      case 7:
        return Layout{false, true, 3, 30, 42};
      case 8:
        return Layout{true, true, 3, 30, 22};
      default:
        return std::nullopt;
    }
  }

  std::size_t bytes() const { return firings * firing_bytes; }
};

LivoxDecoder::LivoxDecoder(const LivoxConfig& config) : config_(config) {
  SLAMD_ASSERT(config.firings_per_second >= 1000 && config.lines > 0);
  SLAMD_ASSERT(config.min_range_m < config.max_range_m);
  const std::uint64_t rate = config.firings_per_second;
  for (std::size_t i = 0; i < offset_ns_.size(); ++i) {
    offset_ns_[i] = static_cast<std::uint32_t>((i * kNanosecondsPerSecond + rate / 2) / rate);
  }
  for (std::size_t i = 0; i < line_.size(); ++i) {
    line_[i] = static_cast<std::uint8_t>(i % config.lines);
  }
}

DecodeResult LivoxDecoder::decode(std::span<const std::byte> payload,
                                  Stamp received,
                                  sensor::PointBlock& block,
                                  ImuReading& imu) {
  const DecodeResult result = decode_checked(payload, received, block, imu);
  ++counters_.packets[static_cast<std::size_t>(result)];
  return result;
}

DecodeResult LivoxDecoder::decode_checked(std::span<const std::byte> payload,
                                          Stamp received,
                                          sensor::PointBlock& block,
                                          ImuReading& imu) {
  if (begins_as_control_frame(payload, kShortestControlFrame)) {
    return DecodeResult::kControlFrame;
  }
  if (payload.size() < DataHeader::kBytes) {
    return DecodeResult::kTooShort;
  }
  const DataHeader header = parse_header(payload);
  if (header.version != DataHeader::kVersion) {
    return DecodeResult::kUnknownVersion;
  }
  const std::optional<Layout> layout = Layout::of(header.data_type);
  if (!layout && header.data_type != kImuDataType) {
    return DecodeResult::kUnknownDataType;
  }
  const std::span<const std::byte> body = payload.subspan(DataHeader::kBytes);
  if (body.size() != (layout ? layout->bytes() : kImuBytes)) {
    return DecodeResult::kWrongLength;
  }
  const std::optional<TimestampType> timestamp_type = timestamp_type_of(header.timestamp_type);
  if (!timestamp_type) {
    return DecodeResult::kBadTimestampType;
  }
  const std::optional<DeviceStamp> stamp = parse_device_stamp(payload, *timestamp_type);
  if (!stamp) {
    return DecodeResult::kBadTimestamp;
  }
  if (layout) {
    block.device_stamp = *stamp;
    block.received = received;
    decode_points(*layout, body, block);
  } else {
    ImuReading reading{*stamp, received};
    if (!read_imu(body, reading)) {
      return DecodeResult::kBadImu;
    }
    imu = reading;
  }
  last_header_ = header;
  return layout ? DecodeResult::kPoints : DecodeResult::kImu;
}

void LivoxDecoder::decode_points(const Layout& layout,
                                 std::span<const std::byte> bytes,
                                 sensor::PointBlock& block) {
  block.stamp = Stamp{};
  block.duration = Duration{offset_ns_[layout.firings]};
  block.empty_firings = 0;
  block.points.clear();
  block.sequences.clear();
  for (std::size_t i = 0; i < layout.firings; ++i) {
    const auto firing = bytes.subspan(i * layout.firing_bytes, layout.firing_bytes);
    sensor::Point point;
    point.offset_ns = offset_ns_[i];
    point.line = line_[i];
    const bool any_return = layout.spherical ? decode_spherical(layout, firing, point, block)
                                             : decode_cartesian(layout, firing, point, block);
    block.empty_firings += any_return ? 0 : 1;
  }
  counters_.points += block.points.size();
  counters_.empty_firings += block.empty_firings;
}

bool LivoxDecoder::decode_cartesian(const Layout& layout,
                                    std::span<const std::byte> firing,
                                    sensor::Point point,
                                    sensor::PointBlock& block) {
  const std::size_t return_bytes = layout.firing_bytes / layout.echoes;
  bool any_return = false;
  for (std::size_t echo = 0; echo < layout.echoes; ++echo) {
    const auto wire = cartesian_return(firing.subspan(echo * return_bytes), layout.tagged);
    if (wire.xyz_mm == std::array<std::int32_t, 3>{}) {
      continue;
    }
    any_return = true;
    point.echo = static_cast<std::uint8_t>(echo);
    point.intensity = wire.reflectivity;
    point.tag = wire.tag;
    append({wire.xyz_mm[0] * 1e-3, wire.xyz_mm[1] * 1e-3, wire.xyz_mm[2] * 1e-3}, point, block);
  }
  return any_return;
}

bool LivoxDecoder::decode_spherical(const Layout& layout,
                                    std::span<const std::byte> firing,
                                    sensor::Point point,
                                    sensor::PointBlock& block) {
  const Direction direction = direction_of(firing, layout.echoes);
  const std::array<double, 3> unit = direction.unit_vector();
  bool any_return = false;
  for (std::size_t echo = 0; echo < layout.echoes; ++echo) {
    const auto wire = spherical_return(firing, echo, layout.echoes, layout.tagged);
    if (wire.depth_mm == 0) {
      continue;
    }
    any_return = true;
    if (!direction.valid()) {
      ++counters_.bad_angles;
      continue;
    }
    const double depth_m = wire.depth_mm * 1e-3;
    point.echo = static_cast<std::uint8_t>(echo);
    point.intensity = wire.reflectivity;
    point.tag = wire.tag;
    append({depth_m * unit[0], depth_m * unit[1], depth_m * unit[2]}, point, block);
  }
  return any_return;
}

/// Gives a return out unless the range gate stops it.
void LivoxDecoder::append(const std::array<double, 3>& p_lidar_m,
                          sensor::Point point,
                          sensor::PointBlock& block) {
  if (!append_within({config_.min_range_m, config_.max_range_m}, p_lidar_m, point, block)) {
    ++counters_.out_of_range;
  }
}

}  // namespace slamd::livox
