#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace slamd::bench {

/// A map and scans to search it with.
struct NeighbourCase {
  std::string name;
  std::size_t stored_points;  // the map holds at least so many when the first scan is searched
  std::size_t queries;        // of a scan, evenly over its points
  float spacing_m;            // of the stored points: side of a sub-cube
  float query_spacing_m;      // of the scan's points before they are counted off
};

/// LIO-SAM's sizes, and a denser scan on a finer map.
std::vector<NeighbourCase> neighbour_cases();

/// How fast a structure answered, median over the scans. Units: ms and µs of CPU time.
struct NeighbourSpeed {
  std::string name;
  double upkeep_ms = 0.0;  // a scan: inserting its points and forgetting old ones, or building anew
  double search_ms = 0.0;  // a scan's queries
  double total_ms = 0.0;
  double query_us = 0.0;
  double recall = 0.0;     // against brute force: 1 when no nearer point was missed
};

/// All structures in one case.
struct NeighbourTable {
  NeighbourCase sizes;
  std::size_t stored_points = 0;  // median of what the structures held
  std::size_t inserted_points = 0;  // of a scan, before the sub-cubes
  std::vector<NeighbourSpeed> structures;  // slamd's first, then the peers
};

/// Drives a simulated VLP-16 through the town and, scan by scan, lets every structure take the scan before and answer
/// the next one's points: the identical stored set in all, k = 5, exact within 1 m.
/// Source: what LIO-SAM does with PCL's KdTreeFLANN, which it builds anew for every scan.
NeighbourTable measure_neighbours(const NeighbourCase& sizes, std::uint64_t seed, int scans,
                                  const std::function<void(double)>& progress);

/// Prints a table with the ratios to the first peer, or to slamd's own search where there is none.
std::string text_of(const NeighbourTable& table);

}  // namespace slamd::bench
