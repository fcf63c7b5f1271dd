#pragma once

#include <string>
#include <vector>

#include "tools/cli/command.hpp"
#include "tools/simulate/faults.hpp"

namespace slamd::simulate {

/// What the command line says of faults.
struct FaultOptions {
  std::string drop, reorder, duplicate, truncate, garbage;
  std::string burst, imu_offset, imu_clip, block_fov;
  std::vector<std::string> clock_steps, blackouts, imu_gaps;
};

/// What the command line of `slamd-simulate faults` says.
struct FaultCommand {
  std::string in;
  std::string out;
  bool force = false;
  std::uint64_t seed = 1;
  FaultOptions faults;
};

/// Declares the faults.
void declare(const cli::Command& app, FaultOptions& options);

void declare(const cli::Command& app, FaultCommand& command);

/// Returns the faults that the options describe. Errors: cli::UsageError names the option and what it takes.
Faults faults_of(const FaultOptions& options, std::uint64_t seed);

/// Tells whether any fault is asked for.
bool asks_for_any(const FaultOptions& options);

}  // namespace slamd::simulate
