#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "daemon/bus/messages.hpp"
#include "daemon/bus/scan_chunks.hpp"

// Between the plain structs and the bytes of lcmtypes/.
namespace slamd::bus {

/// Writes a message; returns its size. Units: bytes.
/// Errors: 0 when the buffer is too small. kLargestMessage_bytes always suffices but for a command with long arguments.
/// Real-time: pose, map_to_odom and chunk do not allocate.
std::size_t encode(const Pose& pose, std::span<std::byte> buffer);
std::size_t encode(const MapToOdom& map_to_odom, std::span<std::byte> buffer);
std::size_t encode(const SubmapPoses& submap_poses, std::span<std::byte> buffer);
std::size_t encode(const ScanChunk& chunk, std::span<std::byte> buffer);
std::size_t encode(const Health& health, std::span<std::byte> buffer);
std::size_t encode(const Command& command, std::span<std::byte> buffer);
std::size_t encode(const Reply& reply, std::span<std::byte> buffer);
std::size_t encode(const VelocityCommand& command, std::span<std::byte> buffer);
std::size_t encode(const Truth& truth, std::span<std::byte> buffer);

/// Reads a message of whoever sent it.
/// Errors: nothing for what is not exactly one whole message of this type with values in their ranges.
std::optional<Pose> decode_pose(std::span<const std::byte> message);
std::optional<MapToOdom> decode_map_to_odom(std::span<const std::byte> message);
std::optional<SubmapPoses> decode_submap_poses(std::span<const std::byte> message);
std::optional<ScanChunk> decode_scan_chunk(std::span<const std::byte> message);
std::optional<Health> decode_health(std::span<const std::byte> message);
std::optional<Command> decode_command(std::span<const std::byte> message);
std::optional<Reply> decode_reply(std::span<const std::byte> message);
std::optional<VelocityCommand> decode_velocity_command(std::span<const std::byte> message);
std::optional<Truth> decode_truth(std::span<const std::byte> message);

}  // namespace slamd::bus
