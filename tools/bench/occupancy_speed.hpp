#pragma once

#include <cstdint>
#include <string>

namespace slamd::bench {

/// What the occupancy grid takes and tells of a VLP-16's scans (10 Hz) along a tour with exact poses.
struct OccupancySpeed {
  double insert_median_ms = 0.0;  // CPU time of a scan
  double insert_p99_ms = 0.0;
  double tell_median_ms = 0.0;    // of making its messages, without encoding and sending
  double bytes_per_s = 0.0;       // of what has changed and key blocks, as LCM carries them
  double points = 0.0;            // a scan, mean
  double changed_blocks = 0.0;    // a scan, mean
  std::size_t blocks = 0;         // of the window
};

/// Measures `scans` of them.
OccupancySpeed measure_occupancy(const std::string& world, std::uint64_t seed, int scans, double cell_m);

}  // namespace slamd::bench
