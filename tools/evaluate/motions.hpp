#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/evaluation/nees.hpp"

namespace slamd::evaluate {

/// Reads the motions.csv of slamd-replay. Errors: RecordingError.
std::vector<evaluation::MotionClaim> read_motions(const std::filesystem::path& file);

/// Prints consistency as JSON: for pose, position, rotation and each axis the mean NEES over its degrees of freedom and
/// the share within the region of 95 %.
std::string json_of(const evaluation::MotionConsistency& consistency);

/// The same as a table.
std::string table_of(const evaluation::MotionConsistency& consistency);

}  // namespace slamd::evaluate
