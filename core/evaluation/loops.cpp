#include "core/evaluation/loops.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/evaluation/median.hpp"

namespace slamd::evaluation {

using geometry::Se3;

namespace {

constexpr double kOpposite_rad = M_PI / 2.0;

struct Place {
  Stamp stamp{};
  double path_m = 0.0;
  Eigen::Vector3d p;
  double heading_rad = 0.0;
};

std::vector<Place> places_of(const Trajectory& truth, double spacing_m) {
  std::vector<Place> places;
  double path_m = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Vector3d& p = truth[i].T.translation();
    path_m += i > 0 ? (p - truth[i - 1].T.translation()).norm() : 0.0;
    if (places.empty() || path_m - places.back().path_m >= spacing_m) {
      const Eigen::Vector3d ahead = truth[i].T.rotation().col(0);
      places.push_back({truth[i].stamp, path_m, p, std::atan2(ahead.y(), ahead.x())});
    }
  }
  return places;
}

double path_at(const std::vector<Place>& places, Stamp stamp) {
  const auto after = std::lower_bound(places.begin(), places.end(), stamp, [](const Place& place, Stamp s) { return place.stamp < s; });
  return after == places.end() ? places.back().path_m : after->path_m;
}

std::vector<Revisit> revisits_among(const std::vector<Place>& places, const RevisitRule& rule) {
  std::vector<Revisit> revisits;
  for (const Place& place : places) {
    bool is_revisit = false;
    bool is_opposite = true;
    for (const Place& earlier : places) {
      if (place.path_m - earlier.path_m < rule.behind_m) {
        break;
      }
      const double turn_rad = std::abs(std::remainder(place.heading_rad - earlier.heading_rad, 2.0 * M_PI));
      if ((place.p - earlier.p).squaredNorm() <= rule.near_m * rule.near_m && turn_rad <= rule.view_rad) {
        is_revisit = true;
        is_opposite = is_opposite && turn_rad > kOpposite_rad;
      }
    }
    if (is_revisit) {
      revisits.push_back({place.stamp, place.path_m, is_opposite});
    }
  }
  return revisits;
}

}  // namespace

std::vector<Revisit> revisits_of(const Trajectory& truth, const RevisitRule& rule) {
  return revisits_among(places_of(truth, rule.spacing_m), rule);
}

LoopQuality loop_quality_of(const Trajectory& truth, std::span<const ClaimedLoop> loops, const RevisitRule& rule) {
  LoopQuality quality;
  const std::vector<Place> places = places_of(truth, rule.spacing_m);
  std::vector<double> errors_m;
  std::vector<double> closed_at_m;  // of the way
  for (const ClaimedLoop& loop : loops) {
    const std::optional<Se3> earlier = interpolated_at(truth, loop.earlier);
    const std::optional<Se3> later = interpolated_at(truth, loop.later);
    if (!earlier || !later) {
      continue;
    }
    const Se3 T_true = earlier->inverse() * *later;
    const double error_m = (T_true.translation() - loop.T_earlier_later.translation()).norm();
    const double error_rad = geometry::angle_between(T_true.rotation(), loop.T_earlier_later.rotation());
    errors_m.push_back(error_m);
    quality.worst_m = std::max(quality.worst_m, error_m);
    quality.worst_rad = std::max(quality.worst_rad, error_rad);
    if (error_m > rule.wrong_m || error_rad > rule.wrong_rad) {
      ++quality.wrong;
    } else {
      closed_at_m.push_back(path_at(places, loop.later));
    }
  }
  quality.loops = errors_m.size();
  quality.median_m = errors_m.empty() ? 0.0 : median_of(errors_m);
  std::sort(closed_at_m.begin(), closed_at_m.end());
  for (const Revisit& revisit : revisits_among(places, rule)) {
    const auto first = std::lower_bound(closed_at_m.begin(), closed_at_m.end(), revisit.path_m - rule.within_m);
    const bool is_closed = first != closed_at_m.end() && *first <= revisit.path_m + rule.within_m;
    ++quality.revisits;
    quality.closed += is_closed ? 1 : 0;
    quality.opposite += revisit.is_opposite ? 1 : 0;
    quality.opposite_closed += revisit.is_opposite && is_closed ? 1 : 0;
  }
  return quality;
}

}  // namespace slamd::evaluation
