#pragma once

#include <cstdint>
#include <span>

#include "core/sensor/point.hpp"

namespace slamd::clouds {

/// Where the points' lines come from; the first that is there is taken.
enum class LineSource : std::uint8_t {
  kField,        // a field ring, line, channel, laser_id or laser
  kRows,         // the rows of an organised cloud
  kFiringOrder,  // one line after the other in the file, as KITTI's are
  kElevation,    // 64 equal steps of elevation: a guess, for clouds in no order
};

inline constexpr std::size_t kMaxGuessedLines = 128;

/// Sets the lines of a cloud whose points come line by line, each line once around (KITTI): a new
/// line begins where the azimuth falls back to the front. Line 0 is the lowest. Returns false, with
/// all lines as they were, when the cloud is not ordered so: neighbours in the file are no
/// neighbours in azimuth, or there are fewer than 4 or more than kMaxGuessedLines lines.
/// Frames: lidar.  Real-time: no allocation.
bool set_lines_by_firing_order(std::span<sensor::Point> points);

/// Sets the lines by elevation and sorts the points by line, then azimuth, so that neighbours in
/// the result are neighbours in space. Frames: lidar.
void set_lines_by_elevation(std::span<sensor::Point> points);

}  // namespace slamd::clouds
