#pragma once

#include <filesystem>
#include <optional>

#include "daemon/stages/gnss_stage.hpp"
#include "daemon/stages/packet_stage.hpp"

namespace slamd::replay {

/// What a recording holds of a satellite receiver. Nothing of it reaches the odometry.
struct GnssSummary {
  stages::GnssState state;
  stages::NamedCounts refused;  // by reason
};

/// Makes the summary of a stage that has read everything.
GnssSummary gnss_summary(const stages::GnssStage& stage);

/// Reads a gnss.csv (by its ending), or what a receiver's port carried, to its end.
/// Errors: RecordingError for a file that cannot be read, or lacks a column.
GnssSummary read_gnss(const std::filesystem::path& file);

}  // namespace slamd::replay
