#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/occupancy/map_delta.hpp"

// Between the map's messages and the bytes of lcmtypes/: what daemon and clients share.
namespace slamd::bus {

/// Writes a message; returns its size. Units: bytes.  Errors: 0 when the buffer is too small; kLargestMessage_bytes suffices.
std::size_t encode(const occupancy::MapDelta& delta, std::span<std::byte> buffer);
std::size_t encode(const occupancy::MapRequest& request, std::span<std::byte> buffer);

/// Reads a message of whoever sent it.
/// Errors: nothing for what is not exactly one whole message of this type with values in their ranges.
std::optional<occupancy::MapDelta> decode_map_delta(std::span<const std::byte> message);
std::optional<occupancy::MapRequest> decode_map_request(std::span<const std::byte> message);

}  // namespace slamd::bus
