#pragma once

#include <algorithm>
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

/// A cube of the coarse grid: running mean and covariance of its points, and the plane or line through them.
/// Frames: odom.  Units: m.
struct SurfaceCell {
  Surface surface = Surface::kUnknown;
  std::uint32_t count = 0;
  std::uint32_t fitted_count = 0;                       // points in the last fit
  float thickness_m = 0.0F;                             // of a plane: one standard deviation across it
  Eigen::Vector3f mean_odom = Eigen::Vector3f::Zero();
  Eigen::Vector3f axis_odom = Eigen::Vector3f::UnitZ();  // the plane's normal, or the line's direction
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();         // of p − anchor
  Eigen::Matrix3f square_sum = Eigen::Matrix3f::Zero();  // of (p − anchor)(p − anchor)ᵀ
  Eigen::Vector3f anchor_odom = Eigen::Vector3f::Zero();  // the first point: keeps the sums small and exact

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

}  // namespace slamd::map
