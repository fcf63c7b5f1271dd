#pragma once

#include <string>
#include <vector>

#include "tools/simulate/faults.hpp"

namespace CLI {
class App;
}

namespace slamd::simulate {

/// What the command line of `slamd-simulate faults` says.
struct FaultOptions {
  std::string in;
  std::string out;
  bool force = false;
  Faults faults;
  std::string drop, reorder, duplicate, truncate, garbage;
  std::string burst, imu_offset, imu_clip, block_fov;
  std::vector<std::string> clock_steps, blackouts, imu_gaps;
};

void declare(CLI::App& app, FaultOptions& options);

/// Returns the faults that the options describe. Errors: cli::UsageError names the option and what it takes.
Faults faults_of(const FaultOptions& options);

}  // namespace slamd::simulate
