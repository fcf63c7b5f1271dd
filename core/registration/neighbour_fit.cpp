#include "core/registration/neighbour_fit.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace slamd::registration {

using map::Neighbours;

namespace {

/// More than rounding makes of distances within a search's radius.
constexpr float kRounding_m = 1e-4F;

PrincipalAxes principal_axes(const Neighbours& neighbours) {
  PrincipalAxes axes;
  axes.mean.setZero();
  for (std::size_t i = 0; i < neighbours.count; ++i) {
    axes.mean += neighbours.points_odom[i];
  }
  const float n = static_cast<float>(neighbours.count);
  axes.mean /= n;
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  for (std::size_t i = 0; i < neighbours.count; ++i) {
    const Eigen::Vector3f d = neighbours.points_odom[i] - axes.mean;
    covariance.noalias() += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance / n);
  axes.lambda = solver.eigenvalues();
  axes.vectors = solver.eigenvectors();
  return axes;
}

}  // namespace

void NeighbourFit::look_up(const map::VoxelMap& map, const Eigen::Vector3f& p_odom, float radius_m) {
  if (is_known() && is_full() && are_still_nearest(p_odom)) {
    return;
  }
  neighbours_ = map.nearest(p_odom, radius_m);
  looked_up_at_odom_ = p_odom;
  others_beyond_m_ = std::sqrt(neighbours_.others_beyond_sq_m2);
  if (is_full()) {
    axes_ = principal_axes(neighbours_);
  }
}

/// Tells whether the neighbours are the nearest to p_odom, too, in the same order, and renews their distances if so. Nothing is
/// near to what is no number.
bool NeighbourFit::are_still_nearest(const Eigen::Vector3f& p_odom) {
  const float others_beyond_m = others_beyond_m_ - (p_odom - looked_up_at_odom_).norm() - kRounding_m;
  std::array<float, Neighbours::kMax> distance_sq_m2;
  for (std::size_t i = 0; i < Neighbours::kMax; ++i) {
    const Eigen::Vector3f d = neighbours_.points_odom[i] - p_odom;
    distance_sq_m2[i] = (d.x() * d.x() + d.y() * d.y()) + d.z() * d.z();
    if (i > 0 && !(distance_sq_m2[i] > distance_sq_m2[i - 1])) {
      return false;
    }
  }
  if (!(others_beyond_m > 0.0F && distance_sq_m2.back() < others_beyond_m * others_beyond_m)) {
    return false;
  }
  neighbours_.distance_sq_m2 = distance_sq_m2;
  return true;
}

}  // namespace slamd::registration
