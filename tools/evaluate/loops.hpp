#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/evaluation/loops.hpp"

namespace slamd::evaluate {

struct LoopOptions {
  std::string truth;    // TUM
  std::string session;  // folder: DIR/session of slamd-replay, or of the daemon
  double near_m = 5.0;
  double view_deg = 180.0;
  double within_m = 20.0;
  bool json = false;
};

/// Reads the loops of a session that its graph believes. Errors: std::runtime_error.
std::vector<evaluation::ClaimedLoop> read_loops(const std::filesystem::path& session);

/// Prints how well a map noticed that the vehicle came back, as JSON.
std::string json_of(const evaluation::LoopQuality& quality);

/// Reads, judges and returns what is to be printed. Errors: RecordingError, std::runtime_error.
std::string evaluate_loops(const LoopOptions& options);

}  // namespace slamd::evaluate
