// Any bytes as messages of the bus: the decoders refuse or understand them, and what was understood encodes again.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "core/occupancy/mirror.hpp"
#include "core/occupancy/queries.hpp"
#include "daemon/bus/encoding.hpp"
#include "daemon/bus/map_encoding.hpp"

namespace {

using namespace slamd::bus;

template <typename Message>
std::vector<std::byte> made(const Message& message) {
  std::vector<std::byte> bytes(kLargestMessage_bytes);
  bytes.resize(encode(message, bytes));
  return bytes;
}

Health full_health() {
  Health health;
  health.causes.resize(health.causes.capacity());
  health.sensors.resize(health.sensors.capacity());
  health.stages.resize(health.stages.capacity());
  health.pools.resize(health.pools.capacity());
  health.counters.resize(health.counters.capacity());
  return health;
}

template <typename Message>
void check(const std::optional<Message>& message) {
  std::array<std::byte, kLargestMessage_bytes> buffer;
  SLAMD_ASSERT(!message || encode(*message, buffer) > 0);
}

/// Asks about both ends of the window, which may lie as far out as a message may put it.
void ask(const slamd::occupancy::StateMap& map) {
  const auto& window = map.window();
  const double block_m = slamd::occupancy::kBlockSide * map.cell_m();
  const Eigen::Vector3d first = block_m * Eigen::Vector3d(window.first.x, window.first.y, window.first.z);
  const Eigen::Vector3d last = first + block_m * Eigen::Vector3d(window.size[0], window.size[1], window.size[2]);
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(1.5 * map.cell_m());
  for (const Eigen::Vector3d& p_odom : {first, last}) {
    const auto counts = count_cells(map, p_odom - margin, p_odom + margin);
    SLAMD_ASSERT(counts.free + counts.occupied <= 5 * 5 * 5);
    const auto obstacle = nearest_obstacle(map, p_odom, block_m);
    SLAMD_ASSERT(!obstacle || map.at(obstacle->cell) == slamd::occupancy::CellState::kOccupied);
  }
}

void feed_map(std::span<const std::byte> message, slamd::occupancy::Mirror& mirror) {
  check(decode_map_request(message));
  const auto delta = decode_map_delta(message);
  check(delta);
  if (delta && delta->window.blocks() < 4096) {
    mirror.apply(*delta);
    ask(mirror.map());
    check(std::optional(mirror.request()));
  }
}

slamd::occupancy::MapDelta full_delta() {
  slamd::occupancy::MapDelta delta;
  delta.map_id = 1;
  delta.covers = {0, 100};
  delta.newest = 100;
  delta.window.size = {4, 4, 4};
  slamd::occupancy::BlockWriter writer(delta);
  slamd::occupancy::SentBlock block;
  for (std::uint64_t number = 1; number < 20; ++number) {
    block.number = number;
    block.index.x = static_cast<std::int32_t>(number % 4);
    block.states.free.fill(number % 3 == 0 ? 0x5555555555555555U : 0xFFFFU);
    writer.add(block);
  }
  return delta;
}

slamd::occupancy::MapRequest full_request() {
  slamd::occupancy::MapRequest request;
  request.ranges = {{1, 2}, {5, 9}};
  return request;
}

void feed(std::span<const std::byte> message, ScanAssembly& assembly) {
  check(decode_pose(message));
  check(decode_map_to_odom(message));
  check(decode_submap_poses(message));
  check(decode_health(message));
  check(decode_reply(message));
  check(decode_velocity_command(message));
  check(decode_truth(message));
  if (const auto command = decode_command(message)) {
    check(command);
    fault_of(*command);
  }
  if (const auto chunk = decode_scan_chunk(message)) {
    check(chunk);
    assembly.add(*chunk);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  // Good messages, for their fingerprints and to be overwritten from some place on.
  static const std::vector<std::vector<std::byte>> kGood{
      made(Pose{}),        made(MapToOdom{}),
      made(full_health()), made(Reply{.id = 1, .ok = true, .text = "done"}),
      made(SubmapPoses{}), made(full_delta()),
      made(full_request()),
      made(Truth{}),       made(VelocityCommand{}),
      made(ScanChunk{}),   made(Command{.id = 1, .verb = "set-pose", .arguments = {"1", "2", "3", "4"}})};
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  ScanAssembly assembly;
  slamd::occupancy::Mirror mirror;
  feed(input, assembly);
  feed_map(input, mirror);
  if (size < 3) {
    return 0;
  }
  std::vector<std::byte> message = kGood[bytes[0] % kGood.size()];
  const std::size_t at = 8 + (std::size_t{bytes[1]} << 8U | bytes[2]) % (message.size() - 8);
  const auto rest = input.subspan(3);
  std::copy_n(rest.begin(), std::min(rest.size(), message.size() - at), message.begin() + static_cast<std::ptrdiff_t>(at));
  feed(message, assembly);
  feed(message, assembly);
  feed_map(made(full_delta()), mirror);
  feed_map(message, mirror);
  return 0;
}
