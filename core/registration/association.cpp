#include "core/registration/association.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::registration {

using geometry::Se3;
using map::Neighbours;
using scan::FeaturePoint;

namespace {

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

/// Brings the map around a later feature nearer to the processor, unless it was looked up before.
void look_ahead(std::size_t i,
                const BoundedVector<FeaturePoint>& features,
                const BoundedVector<NeighbourFit>& fits,
                const Eigen::Matrix3f& R,
                const Eigen::Vector3f& t,
                const map::VoxelMap& map) {
  const std::size_t ahead = i + map::PointGrid::kAhead;
  if (ahead < features.size() && !fits[ahead].is_known()) {
    map.prefetch(R * features[ahead].p_imu + t);
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

Association::Association(const scan::PreprocessConfig& config)
    : constraints(config.max_planar + 2 * config.max_edge), planar(config.max_planar), edge(config.max_edge) {}

void Association::begin(const scan::DeskewedScan& scan) {
  planar.resize(scan.planar.size());
  edge.resize(scan.edge.size());
  for (auto* fits : {&planar, &edge}) {
    for (NeighbourFit& fit : *fits) {
      fit.forget();
    }
  }
}

void associate(const scan::DeskewedScan& scan,
               const map::VoxelMap& map,
               const Se3& T_odom_imu,
               const AssociationConfig& config,
               Association& association) {
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  BoundedVector<Constraint>& out = association.constraints;
  out.clear();
  if (!R.allFinite() || !t.allFinite()) {
    return;  // nothing is near to what is no number
  }
  for (std::size_t i = 0; i < scan.planar.size(); ++i) {
    look_ahead(i, scan.planar, association.planar, R, t, map);
    const FeaturePoint& feature = scan.planar[i];
    const Eigen::Vector3f p_odom = R * feature.p_imu + t;
    NeighbourFit& fit = association.planar[i];
    fit.look_up(map, p_odom, config.search_radius_m);
    if (fit.is_full()) {
      const Neighbours& neighbours = fit.neighbours();
      const PrincipalAxes& axes = fit.axes();
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
  for (std::size_t i = 0; i < scan.edge.size(); ++i) {
    look_ahead(i, scan.edge, association.edge, R, t, map);
    const FeaturePoint& feature = scan.edge[i];
    const Eigen::Vector3f p_odom = R * feature.p_imu + t;
    NeighbourFit& fit = association.edge[i];
    fit.look_up(map, p_odom, config.search_radius_m);
    if (!fit.is_full()) {
      continue;
    }
    const PrincipalAxes& axes = fit.axes();
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
