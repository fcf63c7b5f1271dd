#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace slamd::importing {

/// What an import has done, for the summary on the terminal.
struct Summary {
  std::uint64_t scans = 0;    // or messages with packets
  std::uint64_t packets = 0;  // written to lidar.pcap
  std::uint64_t points = 0;
  std::uint64_t imu_samples = 0;
  std::uint64_t truth_poses = 0;
  std::map<std::string, std::uint64_t> refused;  // by reason
  std::vector<std::string> remarks;              // a line each
};

}  // namespace slamd::importing
