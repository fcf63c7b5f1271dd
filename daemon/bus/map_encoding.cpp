#include "daemon/bus/map_encoding.hpp"

#include <algorithm>
#include <cmath>

#include <slamd_lcm/map_delta_t.hpp>
#include <slamd_lcm/map_request_t.hpp>

#include "core/base/bytes.hpp"
#include "daemon/bus/raw_message.hpp"

namespace slamd::bus {

using occupancy::BlockIndex;
using occupancy::MapDelta;
using occupancy::MapRequest;

namespace {

// Where the counts stand by which lcm-gen's decoders resize, whatever they are, and what stands around what they count.
constexpr std::size_t kDeltaCountAt = 100;
constexpr std::size_t kDeltaHead_bytes = 102;
constexpr std::size_t kRequestCountAt = 16;
constexpr std::size_t kRequestHead_bytes = 18;
constexpr std::size_t kRange_bytes = 16;
static_assert(kDeltaHead_bytes + MapDelta::kPayload_bytes <= kLargestMessage_bytes);

bool counts_fit(std::span<const std::byte> message, std::size_t count_at, std::size_t head_bytes, std::size_t item_bytes, std::size_t most) {
  if (message.size() < head_bytes || message.size() > kLargestMessage_bytes) {
    return false;
  }
  const auto count = load_be<std::int16_t>(message, count_at);
  return count >= 0 && static_cast<std::size_t>(count) <= most && message.size() == head_bytes + item_bytes * static_cast<std::size_t>(count);
}

void write_index(const BlockIndex& index, std::int32_t (&out)[3]) {
  out[0] = index.x;
  out[1] = index.y;
  out[2] = index.z;
}

BlockIndex read_index(const std::int32_t (&in)[3]) { return {in[0], in[1], in[2]}; }

}  // namespace

std::size_t encode(const MapDelta& delta, std::span<std::byte> buffer) {
  slamd_lcm::map_delta_t message;
  message.stamp_ns = delta.stamp.time_since_epoch().count();
  message.map_id = delta.map_id;
  message.epoch = static_cast<std::int32_t>(delta.epoch);
  message.covers_from = static_cast<std::int64_t>(delta.covers.from);
  message.covers_to = static_cast<std::int64_t>(delta.covers.to);
  message.newest = static_cast<std::int64_t>(delta.newest);
  message.digest = static_cast<std::int64_t>(delta.digest);
  message.cell_m = static_cast<float>(delta.cell_m);
  write_index(delta.window.first, message.window_first);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    message.window_size[axis] = static_cast<std::int16_t>(delta.window.size[axis]);
  }
  message.submap = delta.submap;
  write_index(delta.anchor, message.anchor);
  message.block_count = static_cast<std::int16_t>(delta.blocks);
  message.byte_count = static_cast<std::int16_t>(delta.payload.size());
  message.bytes.resize(delta.payload.size());
  std::transform(delta.payload.begin(), delta.payload.end(), message.bytes.begin(), [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return write_raw(message, buffer);
}

std::optional<MapDelta> decode_map_delta(std::span<const std::byte> bytes) {
  slamd_lcm::map_delta_t message;
  if (!counts_fit(bytes, kDeltaCountAt, kDeltaHead_bytes, 1, MapDelta::kPayload_bytes) || !read_raw(bytes, message) || message.covers_from < 0 ||
      message.block_count < 0) {
    return std::nullopt;
  }
  MapDelta delta;
  delta.stamp = Stamp(Duration(message.stamp_ns));
  delta.map_id = message.map_id;
  delta.epoch = static_cast<std::uint32_t>(message.epoch);
  delta.covers = {static_cast<std::uint64_t>(message.covers_from), static_cast<std::uint64_t>(message.covers_to)};
  delta.newest = static_cast<std::uint64_t>(message.newest);
  delta.digest = static_cast<std::uint64_t>(message.digest);
  delta.cell_m = std::round(1e6 * static_cast<double>(message.cell_m)) / 1e6;  // 0.2, not 0.20000000298
  delta.window.first = read_index(message.window_first);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    delta.window.size[axis] = message.window_size[axis];
  }
  delta.submap = message.submap;
  delta.anchor = read_index(message.anchor);
  delta.blocks = static_cast<std::uint16_t>(message.block_count);
  delta.payload.resize(message.bytes.size());
  std::transform(message.bytes.begin(), message.bytes.end(), delta.payload.begin(), [](std::uint8_t byte) { return std::byte{byte}; });
  if (message.map_id <= 0 || !is_well_formed(delta)) {
    return std::nullopt;
  }
  return delta;
}

std::size_t encode(const MapRequest& request, std::span<std::byte> buffer) {
  slamd_lcm::map_request_t message;
  message.map_id = request.map_id;
  message.range_count = static_cast<std::int16_t>(request.ranges.size());
  for (const occupancy::NumberRange& range : request.ranges) {
    message.ranges.push_back({static_cast<std::int64_t>(range.from), static_cast<std::int64_t>(range.to)});
  }
  return write_raw(message, buffer);
}

std::optional<MapRequest> decode_map_request(std::span<const std::byte> bytes) {
  slamd_lcm::map_request_t message;
  if (!counts_fit(bytes, kRequestCountAt, kRequestHead_bytes, kRange_bytes, MapRequest::kRanges) || !read_raw(bytes, message) ||
      message.ranges.empty()) {
    return std::nullopt;
  }
  MapRequest request;
  request.map_id = message.map_id;
  for (const auto& range : message.ranges) {
    if (range[0] < 0 || range[1] <= range[0]) {
      return std::nullopt;
    }
    request.ranges.push_back({static_cast<std::uint64_t>(range[0]), static_cast<std::uint64_t>(range[1])});
  }
  return request;
}

}  // namespace slamd::bus
