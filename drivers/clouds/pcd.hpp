#pragma once

#include <optional>
#include <span>

#include "drivers/clouds/raw_cloud.hpp"

namespace slamd::clouds {

/// Takes a PCD file apart (version 0.7 and its elders): ascii, binary and binary_compressed, any
/// fields. Of a field with COUNT > 1 the first value is kept; VIEWPOINT is ignored (points stay as
/// written); bytes after the last point are ignored (some writers fill the last page). The result
/// refers to `file` or to its own memory, which the file's length bounds. Errors: see CloudRefusal.
std::optional<CloudRefusal> parse_pcd(std::span<const std::byte> file, RawCloud& cloud);

}  // namespace slamd::clouds
