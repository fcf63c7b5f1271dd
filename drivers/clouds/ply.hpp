#pragma once

#include <optional>
#include <span>

#include "drivers/clouds/raw_cloud.hpp"

namespace slamd::clouds {

/// Takes the vertices of a PLY file apart: ascii, binary little-endian and big-endian, any scalar
/// properties (also int64 and uint64, which the format's description lacks). Elements behind the
/// vertices are ignored. The result refers to `file` or to its own memory, which the file's length
/// bounds. Errors: see CloudRefusal; kUnsupported for lists among the vertices and for elements in
/// front of them.
std::optional<CloudRefusal> parse_ply(std::span<const std::byte> file, RawCloud& cloud);

}  // namespace slamd::clouds
