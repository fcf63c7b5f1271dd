#pragma once

#include "tools/map/session_cloud.hpp"

namespace slamd::map {

/// What optimising anew has made of a session's loops.
struct Reoptimised {
  std::size_t accepted = 0;
  std::size_t taken_out = 0;   // that were accepted before
  std::size_t taken_in = 0;    // that were not
  double largest_move_m = 0.0;  // of a keyframe
};

/// Runs the graph of a session again, from odometry, gravity and all loops that were ever verified, in the order in which
/// they came, and puts the new poses and verdicts into it.
/// Errors: std::runtime_error where the graph refuses a keyframe.
Reoptimised reoptimise(storage::Session& session, const Share& share = {});

}  // namespace slamd::map
