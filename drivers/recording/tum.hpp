#pragma once

#include <cstdio>
#include <filesystem>
#include <vector>

#include "core/geometry/se3.hpp"
#include "drivers/recording/packet.hpp"

namespace slamd::recording {

/// A pose at a time. What the frames are, the file's name says (truth.tum: base in world).
struct StampedPose {
  Stamp stamp{};
  geometry::Se3 T;
};

/// Reads a TUM trajectory: `t x y z qx qy qz qw` a line, t in seconds, # for comments. Stamps are read to the
/// nanosecond, not through a double. Errors: RecordingError with the line.
std::vector<StampedPose> read_tum(const std::filesystem::path& file);

/// Reads KITTI rows (3 × 4, row-major) with a file of stamps in seconds, one a row. Errors: RecordingError.
std::vector<StampedPose> read_kitti(const std::filesystem::path& file, const std::filesystem::path& times);

/// Tells whether a file holds KITTI rows: 12 numbers in its first row that is no comment. Errors: RecordingError.
bool is_kitti(const std::filesystem::path& file);

/// Appends one TUM line. Units: s with nanoseconds, m.
void write_tum_line(std::FILE* stream, Stamp stamp, const geometry::Se3& T);

}  // namespace slamd::recording
