#include "core/map/surface_cell.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace slamd::map {

namespace {

constexpr std::uint32_t kMinPoints = 5;
/// Past this many points a cell's mean hardly moves any more; it stops learning and costs nothing.
constexpr std::uint32_t kMaxPoints = 200;

}  // namespace

void SurfaceCell::add(const Eigen::Vector3f& p_odom) {
  if (count >= kMaxPoints) {
    return;
  }
  if (count == 0) {
    anchor_odom = p_odom;
  }
  ++count;
  const Eigen::Vector3f d = p_odom - anchor_odom;
  sum += d;
  square_sum[0] += d.x() * d.x();
  square_sum[1] += d.x() * d.y();
  square_sum[2] += d.x() * d.z();
  square_sum[3] += d.y() * d.y();
  square_sum[4] += d.y() * d.z();
  square_sum[5] += d.z() * d.z();
  if (count >= kMinPoints && 4 * count >= 5 * fitted_count) {
    fit();
  }
}

Eigen::Vector3f SurfaceCell::normal_near(const Eigen::Vector3f& p_odom) const {
  if (surface == Surface::kPlane) {
    return axis_odom;
  }
  const Eigen::Vector3f upright = axis_odom.cross(Eigen::Vector3f::UnitZ()).normalized();
  const Eigen::Vector3f level = upright.cross(axis_odom);
  const Eigen::Vector3f d = p_odom - mean_odom;
  return std::abs(level.dot(d)) < std::abs(upright.dot(d)) ? level : upright;
}

void SurfaceCell::fit() {
  fitted_count = count;
  const float n = static_cast<float>(count);
  const Eigen::Vector3f mean = sum / n;
  mean_odom = anchor_odom + mean;
  Eigen::Matrix3f squares;
  squares << square_sum[0], square_sum[1], square_sum[2],  //
      square_sum[1], square_sum[3], square_sum[4],         //
      square_sum[2], square_sum[4], square_sum[5];
  const Eigen::Matrix3f covariance = squares / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f& lambda = solver.eigenvalues();
  const float floor = 1e-5F;  // (3 mm)²: below the sensor's noise ratios mean nothing
  if (lambda[2] > 8.0F * std::max(lambda[1], floor)) {
    axis_odom = solver.eigenvectors().col(2);
    surface = std::abs(axis_odom.z()) > 0.5F ? Surface::kLine : Surface::kRing;
  } else if (lambda[1] > 4.0F * std::max(lambda[0], floor)) {
    surface = Surface::kPlane;
    axis_odom = solver.eigenvectors().col(0);
    thickness_m = std::sqrt(std::max(0.0F, lambda[0]));
  } else {
    surface = Surface::kUnknown;
  }
}

}  // namespace slamd::map
