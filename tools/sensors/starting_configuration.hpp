#pragma once

#include <filesystem>
#include <string>

#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Writes a configuration to begin with: the sensors that were found, a comment for each line that says what of them was
/// seen, and what nobody can hear (where they sit) to be filled in. slamd accepts it as it is.
/// when: the time, in words, for its first line.
/// Errors: std::runtime_error when there is no LiDAR that slamd reads: without one there is nothing to configure.
std::string starting_configuration(const Seen& seen, const std::string& when);

/// Writes a file that is not there yet; with `force` also in the place of one that is.
/// Errors: std::runtime_error.
void write_file(const std::filesystem::path& file, const std::string& text, bool force);

}  // namespace slamd::sensors
