#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/stamp.hpp"
#include "core/evaluation/trajectory.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::evaluation {

/// What counts as having come back, and what as having noticed it.
struct RevisitRule {
  double near_m = 5.0;      // of a place passed before; 2 m indoors
  double view_rad = 3.2;    // between the headings, at most; less for a sensor that does not look around
  double behind_m = 40.0;   // of the way, at least: nearer, it is one pass
  double spacing_m = 1.0;   // of the places along the way that are asked
  double within_m = 20.0;   // of the way: a loop so far before or behind closes a revisit
  double wrong_m = 0.3;     // a loop farther off the truth is wrong
  double wrong_rad = 0.0524;  // 3°
};

/// A place of the way that was passed before.
struct Revisit {
  Stamp stamp{};
  double path_m = 0.0;
  bool is_opposite = false;  // all earlier passes went the other way: headings differ by more than 90°
};

/// Returns the revisits of a way, by what is true of it: places `spacing_m` apart that have an earlier one of the rule near.
/// O(places²).
std::vector<Revisit> revisits_of(const Trajectory& truth, const RevisitRule& rule);

/// A loop that a map believes.
struct ClaimedLoop {
  Stamp earlier{};
  Stamp later{};
  geometry::Se3 T_earlier_later;
};

/// How well a map noticed that the vehicle came back.
struct LoopQuality {
  std::size_t revisits = 0;
  std::size_t closed = 0;            // with a right loop within the rule's way
  std::size_t opposite = 0;          // of the revisits
  std::size_t opposite_closed = 0;
  std::size_t loops = 0;             // that the truth can judge
  std::size_t wrong = 0;
  double median_m = 0.0;             // error of the loops
  double worst_m = 0.0;
  double worst_rad = 0.0;

  double recall() const { return revisits == 0 ? 1.0 : static_cast<double>(closed) / static_cast<double>(revisits); }
};

/// Judges loops by the truth, which is interpolated at their stamps; loops outside of it are left out.
LoopQuality loop_quality_of(const Trajectory& truth, std::span<const ClaimedLoop> loops, const RevisitRule& rule);

}  // namespace slamd::evaluation
