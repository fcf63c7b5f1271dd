#include "drivers/can/aceinna_imu.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"

namespace slamd::can {

using imu::InertialResult;

namespace {

constexpr std::uint32_t kRateGroup = 0xF02A;
constexpr std::uint32_t kForceGroup = 0xF02D;
constexpr std::uint32_t kRateHighResolution = 0xFF6B;
constexpr std::uint32_t kForceHighResolution = 0xFF6D;
constexpr Duration kLatencyUnit = std::chrono::microseconds{500};

/// The group number of a broadcast: bits 8 to 25 of the id.
std::uint32_t group_of(const CanFrame& frame) { return frame.id >> 8 & 0x3FFFF; }

/// Three numbers of 16 bits; nothing where the device marks one as an error (0xFE..) or not available (0xFF..).
std::optional<Eigen::Vector3d> three_words(std::span<const std::byte> data, double unit, double offset) {
  Eigen::Vector3d result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto raw = load_le<std::uint16_t>(data, 2 * i);
    if (raw >= 0xFE00) {
      return std::nullopt;
    }
    result[static_cast<Eigen::Index>(i)] = raw * unit - offset;
  }
  return result;
}

/// Three numbers of 19 bits; nothing where the upper eight mark one as above.
std::optional<Eigen::Vector3d> three_packed(std::span<const std::byte> data, double unit, double offset) {
  const auto all = load_le<std::uint64_t>(data, 0);
  Eigen::Vector3d result;
  for (unsigned i = 0; i < 3; ++i) {
    const auto raw = static_cast<std::uint32_t>(all >> 19 * i & 0x7FFFF);
    if (raw >> 11 >= 0xFE) {
      return std::nullopt;
    }
    result[static_cast<Eigen::Index>(i)] = raw * unit - offset;
  }
  return result;
}

}  // namespace

std::optional<AxisMap> parse_axis_map(std::string_view text) {
  AxisMap map;
  std::array<bool, 3> seen{};
  for (std::uint8_t place = 0; place < 3; ++place) {
    const std::string_view word = text.substr(0, text.find(','));
    const bool is_turned = word.starts_with('-');
    const std::string_view name = word.substr(is_turned ? 1 : 0);
    if (name.size() != 1 || name[0] < 'x' || name[0] > 'z') {
      return std::nullopt;
    }
    const auto axis = static_cast<std::size_t>(name[0] - 'x');
    if (seen[axis] || (text.size() == word.size()) != (place == 2)) {
      return std::nullopt;
    }
    seen[axis] = true;
    map.wire[axis] = place;
    map.sign[axis] = is_turned ? -1.0 : 1.0;
    text.remove_prefix(std::min(text.size(), word.size() + 1));
  }
  return map;
}

std::vector<transport::CanFilter> AceinnaReader::frames(std::optional<std::uint8_t> source) {
  std::vector<transport::CanFilter> filters;
  for (const std::uint32_t group : {kRateGroup, kForceGroup, kRateHighResolution, kForceHighResolution}) {
    // Whatever the priority; without a source, whatever that.
    filters.push_back({group << 8 | source.value_or(0), source ? 0x03FF'FFFFU : 0x03FF'FF00U, true});
  }
  return filters;
}

bool AceinnaReader::take(const CanFrame& frame, sensor::ImuReading& reading) {
  const std::uint32_t group = group_of(frame);
  const bool is_high = group == kRateHighResolution || group == kForceHighResolution;
  const bool is_rate = group == kRateGroup || group == kRateHighResolution;
  const bool is_force = group == kForceGroup || group == kForceHighResolution;
  if (!frame.is_extended || (!is_rate && !is_force) || (source_ && (frame.id & 0xFF) != *source_)) {
    count(InertialResult::kOther);
    return false;
  }
  if (frame.size != 8) {
    count(InertialResult::kMalformed);
    return false;
  }
  const std::span<const std::byte> data = frame.bytes();
  std::optional<Eigen::Vector3d> on_wire;
  if (is_high) {
    on_wire = is_rate ? three_packed(data, 1.0 / 1024.0, 250.0) : three_packed(data, 1.0 / 800.0, 320.0);
  } else {
    on_wire = is_rate ? three_words(data, 1.0 / 128.0, 250.0) : three_words(data, 0.01, 320.0);
  }
  if (!on_wire) {
    count(InertialResult::kIncomplete);
    return false;
  }
  // The high-resolution frames use all bits but seven, and state no latency.
  const Duration latency = is_high ? Duration::zero() : load_le<std::uint8_t>(data, 7) * kLatencyUnit;
  std::optional<Half>& own = is_rate ? rate_ : force_;
  const std::optional<Half>& other = is_rate ? force_ : rate_;
  if (own) {
    count(InertialResult::kIncomplete);  // its counterpart has not come
  }
  own = Half{in_imu(*on_wire) * (is_rate ? kDegree : 1.0), frame.received, frame.received - latency};
  if (!other) {
    return false;
  }
  if (frame.received - other->received > kTogether) {
    count(InertialResult::kIncomplete);
    (is_rate ? force_ : rate_).reset();
    return false;
  }
  reading.device_stamp = DeviceStamp{own->measured.time_since_epoch()};
  reading.received = frame.received;
  reading.angular_rate_radps = rate_->value;
  reading.specific_force_mps2 = force_->value;
  rate_.reset();
  force_.reset();
  const InertialResult result = imu::judge(reading);
  count(result);
  return result == InertialResult::kSample;
}

Eigen::Vector3d AceinnaReader::in_imu(const Eigen::Vector3d& on_wire) const {
  Eigen::Vector3d result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result[static_cast<Eigen::Index>(axis)] = axes_.sign[axis] * on_wire[axes_.wire[axis]];
  }
  return result;
}

}  // namespace slamd::can
