#include "drivers/can/xsens_can.hpp"

#include <bit>

#include "core/base/bytes.hpp"

namespace slamd::can {

using imu::InertialResult;

namespace {

constexpr Duration kTick = std::chrono::microseconds{100};
constexpr std::uint32_t kClipping = 1U << 19;

/// The quantities of use, and their ids as delivered.
enum Quantity : std::uint32_t { kTime = 1, kCounter = 2, kStatus = 4, kRate = 8, kForce = 16 };
constexpr std::uint32_t kSample = kTime | kRate | kForce;

struct Layout {
  std::uint32_t id;
  Quantity quantity;
  std::size_t bytes;
  bool is_high_resolution = false;
};

constexpr Layout kLayouts[] = {{0x005, kTime, 4},  {0x006, kCounter, 2},    {0x011, kStatus, 4},    {0x032, kRate, 6},
                               {0x034, kForce, 6}, {0x061, kRate, 6, true}, {0x062, kForce, 6, true}};

const Layout* layout_of(const CanFrame& frame) {
  for (const Layout& layout : kLayouts) {
    if (!frame.is_extended && frame.id == layout.id) {
      return &layout;
    }
  }
  return nullptr;
}

Eigen::Vector3d vector_at(std::span<const std::byte> data, double unit) {
  return unit * Eigen::Vector3d(load_be<std::int16_t>(data, 0), load_be<std::int16_t>(data, 2), load_be<std::int16_t>(data, 4));
}

}  // namespace

std::vector<transport::CanFilter> XsensCanReader::frames() {
  std::vector<transport::CanFilter> filters;
  for (const Layout& layout : kLayouts) {
    filters.push_back({.id = layout.id});
  }
  return filters;
}

bool XsensCanReader::take(const CanFrame& frame, sensor::ImuReading& reading) {
  const Layout* layout = layout_of(frame);
  if (layout == nullptr) {
    count(InertialResult::kOther);
    return false;
  }
  if (frame.size != layout->bytes) {
    count(InertialResult::kMalformed);
    return false;
  }
  if (layout->is_high_resolution) {
    high_resolution_ |= layout->quantity;
  } else if ((high_resolution_ & layout->quantity) != 0) {
    count(InertialResult::kOther);  // the sensor sends the better one, too
    return false;
  }
  // The time comes first: what was measured before it belongs to another sample.
  const std::uint32_t ends_group = layout->quantity == kTime ? kTime | kRate | kForce : layout->quantity;
  if ((group_.seen & ends_group) != 0) {
    begin_group();
  }
  group_.seen |= layout->quantity;
  const std::span<const std::byte> data = frame.bytes();
  switch (layout->quantity) {
    case kTime: group_.ticks = load_be<std::uint32_t>(data, 0); break;
    case kCounter: note_counter(load_be<std::uint16_t>(data, 0)); break;
    case kStatus: counters_.clipped += (load_be<std::uint32_t>(data, 0) & kClipping) != 0 ? 1 : 0; break;
    case kRate: group_.angular_rate_radps = vector_at(data, 1.0 / 512.0); break;
    case kForce: group_.specific_force_mps2 = vector_at(data, 1.0 / 256.0); break;
  }
  return !group_.is_complete && (group_.seen & kSample) == kSample && finish(frame.received, reading);
}

void XsensCanReader::begin_group() {
  if (!group_.is_complete) {
    count(InertialResult::kIncomplete);
  }
  group_ = {};
}

void XsensCanReader::note_counter(std::uint16_t counter) {
  if (last_counter_) {
    const auto step = static_cast<std::uint16_t>(counter - *last_counter_);
    counters_.missing += step > 1 && step < 0x8000 ? step - 1U : 0U;
  }
  last_counter_ = counter;
}

bool XsensCanReader::finish(Stamp received, sensor::ImuReading& reading) {
  group_.is_complete = true;
  // A step of more than half the range is one backwards: the device began anew.
  ticks_ += last_ticks_ ? std::bit_cast<std::int32_t>(group_.ticks - *last_ticks_) : std::int64_t{group_.ticks};
  last_ticks_ = group_.ticks;
  reading.device_stamp = DeviceStamp{ticks_ * kTick};
  reading.received = received;
  reading.angular_rate_radps = group_.angular_rate_radps;
  reading.specific_force_mps2 = group_.specific_force_mps2;
  const InertialResult result = imu::judge(reading);
  count(result);
  return result == InertialResult::kSample;
}

}  // namespace slamd::can
