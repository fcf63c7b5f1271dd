#include "core/registration/association.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace slamd::registration {

using geometry::Se3;
using map::Neighbours;
using scan::FeaturePoint;

namespace {

/// Centre and principal axes of a few neighbours.
struct PrincipalAxes {
  Eigen::Vector3f mean;
  Eigen::Vector3f lambda;   // ascending
  Eigen::Matrix3f vectors;  // columns, in the order of lambda
};

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

/// Neighbours this close to a line span no plane. Units: m².
constexpr float kMinPlaneLambda = 0.03F * 0.03F;

/// Five points may lie in a plane by chance: their own spread across it is no less than this.  Units: m.
constexpr float kLeastAcross_m = 0.01F;

const Eigen::Vector3f kNoTilt = Eigen::Vector3f::Zero();

/// The surface cells that stand in where the neighbours span no plane: the larger ones.
constexpr std::size_t kSparseLevel = 1;

bool spans_plane(const Neighbours& neighbours, const PrincipalAxes& axes, const AssociationConfig& config) {
  if (axes.lambda[1] < kMinPlaneLambda || axes.lambda[1] < 4.0F * axes.lambda[0]) {
    return false;
  }
  const Eigen::Vector3f n = axes.vectors.col(0);
  for (std::size_t i = 0; i < neighbours.count; ++i) {
    if (std::abs(n.dot(neighbours.points_odom[i] - axes.mean)) > config.plane_thickness_m) {
      return false;
    }
  }
  return true;
}

/// The normal's most uncertain axis times its standard deviation: what the noise across a plane does to the fit of n
/// points, σ²/(n·λ) along the axis of the smaller spread.  Units: rad.
Eigen::Vector3f tilt_of(const Neighbours& neighbours, const PrincipalAxes& axes) {
  const float n = static_cast<float>(neighbours.count);
  const float across_sq = std::max(axes.lambda[0] * n / (n - 3.0F), kLeastAcross_m * kLeastAcross_m);
  return std::sqrt(across_sq / (n * axes.lambda[1])) * axes.vectors.col(1);
}

/// Brings the map around a later feature nearer to the processor.
void look_ahead(const FeaturePoint& feature,
                const BoundedVector<FeaturePoint>& features,
                const Eigen::Matrix3f& R,
                const Eigen::Vector3f& t,
                const map::VoxelMap& map) {
  if (features.end() - &feature > map::PointGrid::kAhead) {
    map.prefetch(R * (&feature + map::PointGrid::kAhead)->p_imu + t);
  }
}

/// Adds the plane through `centre` with normal n unless the point is too far from it.
void add_if_near(const FeaturePoint& feature,
                 const Eigen::Vector3f& p_odom,
                 const Eigen::Vector3f& n_odom,
                 const Eigen::Vector3f& centre_odom,
                 float std_m,
                 const Eigen::Vector3f& tilt_odom,
                 const AssociationConfig& config,
                 BoundedVector<Constraint>& out) {
  const float d_m = -n_odom.dot(centre_odom);
  const float gate_m = config.gate_slope * std::sqrt(feature.range_m);
  if (std::abs(n_odom.dot(p_odom) + d_m) > gate_m) {
    return;
  }
  const float beam_m = config.angular_std_rad * feature.range_m;
  out.try_push_back({feature.p_imu, n_odom, d_m, 1.0F / (std_m * std_m + beam_m * beam_m), tilt_odom});
}

}  // namespace

void associate(const scan::DeskewedScan& scan,
               const map::VoxelMap& map,
               const Se3& T_odom_imu,
               const AssociationConfig& config,
               BoundedVector<Constraint>& out) {
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  out.clear();
  for (const FeaturePoint& feature : scan.planar) {
    look_ahead(feature, scan.planar, R, t, map);
    const Eigen::Vector3f p_odom = R * feature.p_imu + t;
    const Neighbours neighbours = map.nearest(p_odom, config.search_radius_m);
    if (neighbours.count == Neighbours::kMax) {
      const PrincipalAxes axes = principal_axes(neighbours);
      if (spans_plane(neighbours, axes, config)) {
        add_if_near(feature, p_odom, axes.vectors.col(0), axes.mean, config.planar_std_m, tilt_of(neighbours, axes),
                    config, out);
        continue;
      }
    }
    // Rings on the ground lie too far apart for five neighbours to span a plane; a larger cell sees several.
    const map::SurfaceCell* cell = map.surface(p_odom, kSparseLevel);
    if (cell != nullptr && cell->surface == map::Surface::kPlane && cell->thickness_m < config.sparse_thickness_m) {
      add_if_near(feature, p_odom, cell->axis_odom, cell->mean_odom, config.sparse_std_m, kNoTilt, config, out);
    }
  }
  for (const FeaturePoint& feature : scan.edge) {
    look_ahead(feature, scan.edge, R, t, map);
    const Eigen::Vector3f p_odom = R * feature.p_imu + t;
    const Neighbours neighbours = map.nearest(p_odom, config.search_radius_m);
    if (neighbours.count < Neighbours::kMax) {
      continue;
    }
    const PrincipalAxes axes = principal_axes(neighbours);
    if (axes.lambda[2] > config.line_ratio * std::max(axes.lambda[1], 1e-5F)) {
      add_if_near(feature, p_odom, axes.vectors.col(0), axes.mean, config.edge_std_m, kNoTilt, config, out);
      add_if_near(feature, p_odom, axes.vectors.col(1), axes.mean, config.edge_std_m, kNoTilt, config, out);
    }
  }
}

void associate_surfaces(std::span<const Eigen::Vector3f> points_imu,
                        const map::VoxelMap& map,
                        std::size_t level,
                        float gate_m,
                        const Se3& T_odom_imu,
                        BoundedVector<Constraint>& out) {
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  out.clear();
  for (const Eigen::Vector3f& p_imu : points_imu) {
    const Eigen::Vector3f p_odom = R * p_imu + t;
    const map::SurfaceCell* cell = map.surface(p_odom, level);
    if (cell == nullptr || cell->surface == map::Surface::kUnknown || cell->distance_m(p_odom) > gate_m) {
      continue;
    }
    if (cell->surface != map::Surface::kLine) {
      const Eigen::Vector3f n_odom = cell->normal_near(p_odom);
      out.try_push_back({p_imu, n_odom, -n_odom.dot(cell->mean_odom), 1.0F});
      continue;
    }
    const Eigen::Vector3f across = cell->axis_odom.unitOrthogonal();
    const Eigen::Vector3f other = cell->axis_odom.cross(across);
    out.try_push_back({p_imu, across, -across.dot(cell->mean_odom), 1.0F});
    out.try_push_back({p_imu, other, -other.dot(cell->mean_odom), 1.0F});
  }
}

}  // namespace slamd::registration
