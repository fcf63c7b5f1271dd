#pragma once

#include <filesystem>
#include <vector>

#include "tools/simulate/surfaces.hpp"

namespace slamd::simulate {

/// Reads the faces of a PLY file (ascii or binary little-endian; polygons become fans of triangles).
/// Errors: RecordingError with the cause.
std::vector<Triangle> read_mesh(const std::filesystem::path& file);

}  // namespace slamd::simulate
