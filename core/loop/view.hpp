#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "core/geometry/se3.hpp"

namespace slamd::loop {

/// How many points of another cloud a view has looked through.
struct SeenThrough {
  std::size_t in_field = 0;
  std::size_t through = 0;

  /// Of those in the field; 0 where these are few.
  double share() const { return share_of_at_least(1); }

  /// Likewise, but of so many at least: in a smaller field one stray point would be a large share.
  double share_of_at_least(std::size_t points) const {
    return in_field < 50 ? 0.0 : static_cast<double>(through) / static_cast<double>(std::max(points, in_field));
  }
};

/// What was seen from one place: the nearest range in each direction, 3° by 3°.
/// A surface that another cloud puts well before all that was seen in its direction and around it cannot be there: it would
/// have been seen. Two clouds that are laid on each other wrongly, one row of shelves on the next, contradict each other so,
/// however well they fit.
/// Real-time: no allocation.
class View {
 public:
  View() { clear(); }

  void clear() { nearest_m_.fill(std::numeric_limits<float>::infinity()); }

  /// Adds points as seen from the place.  Units: m.
  void add(std::span<const Eigen::Vector3f> points_view);

  /// Counts the points that lie where the view has looked through, of those that lie in its field.
  SeenThrough seen_through(std::span<const Eigen::Vector3f> points, const geometry::Se3& T_view_points) const;

 private:
  static constexpr int kAzimuths = 120;
  static constexpr int kElevations = 30;  // −45° to 45°

  /// Finds the bin of a direction; false outside the elevations.
  static bool bin_of(const Eigen::Vector3f& p, int& azimuth, int& elevation);

  /// The nearest of the 3 × 3 directions around; infinity where fewer than most of them have been seen.
  float nearest_around_m(int azimuth, int elevation) const;

  std::array<float, static_cast<std::size_t>(kAzimuths * kElevations)> nearest_m_;
};

}  // namespace slamd::loop
