#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace slamd::map {

/// What the points of a coarse cell form.
enum class Surface : std::uint8_t {
  kUnknown,  // too few points, or a blob
  kPlane,    // λ₁ > 4 λ₀
  kLine,     // λ₂ > 8 λ₁, upright: a pole
  kRing,     // the same, level: as a rule one ring of beams on a floor or a wall, nobody knows which
};

/// A cube of the coarse grid: running mean and covariance of its points, and the plane or line through them. What a point
/// that comes in needs fills one cache line, what a query needs half of another.
/// Frames: odom.  Units: m.
struct alignas(64) SurfaceCell {
  std::uint32_t count = 0;
  std::uint32_t fitted_count = 0;                         // points in the last fit
  Eigen::Vector3f anchor_odom = Eigen::Vector3f::Zero();  // the first point: keeps the sums small and exact
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();          // of p − anchor
  std::array<float, 6> square_sum{};                      // of (p − anchor)(p − anchor)ᵀ: xx, xy, xz, yy, yz, zz

  alignas(64) Surface surface = Surface::kUnknown;
  float thickness_m = 0.0F;  // of a plane: one standard deviation across it
  Eigen::Vector3f mean_odom = Eigen::Vector3f::Zero();
  Eigen::Vector3f axis_odom = Eigen::Vector3f::UnitZ();  // the plane's normal, or the line's direction

  void clear() { *this = SurfaceCell{}; }

  /// Takes a point in, and fits anew when the number of points has grown by a quarter.
  void add(const Eigen::Vector3f& p_odom);

  /// Returns the normal of the plane, or of a ring: that of the floor or of the wall through it, whichever is nearer.
  Eigen::Vector3f normal_near(const Eigen::Vector3f& p_odom) const;

  /// Returns the distance to the surface. Units: m.
  float distance_m(const Eigen::Vector3f& p_odom) const {
    const Eigen::Vector3f d = p_odom - mean_odom;
    const float along = axis_odom.dot(d);
    if (surface == Surface::kRing) {
      return std::abs(normal_near(p_odom).dot(d));
    }
    if (surface == Surface::kPlane) {
      return std::abs(along);
    }
    return std::sqrt(std::max(0.0F, d.squaredNorm() - along * along));
  }

 private:
  void fit();
};

static_assert(sizeof(SurfaceCell) == 128);

}  // namespace slamd::map
