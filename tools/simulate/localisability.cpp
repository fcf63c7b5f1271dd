#include "tools/simulate/localisability.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/geometry/so3.hpp"
#include "tools/simulate/text_file.hpp"

namespace slamd::simulate {

namespace {

constexpr double kScan_s = 0.1;
constexpr int kBeams = 1500;
constexpr double kBeside_rad = 2e-4;  // to the beams that find the normal
constexpr double kCosTolerance = 0.02;

/// The normal of the surface that a beam meets, from two beams beside it; none at an edge or in leaves.
std::optional<Eigen::Vector3d> normal_at(const World& world, const Eigen::Vector3d& eye, const Eigen::Vector3d& d,
                                         double max_range_m, std::uint64_t ray, const Hit& hit) {
  const Eigen::Vector3d side =
      d.cross(std::abs(d.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX()).normalized();
  const Eigen::Vector3d up = side.cross(d);
  Eigen::Vector3d edge[2];
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d beside = (d + kBeside_rad * (i == 0 ? side : up)).normalized();
    Hit other;
    if (!world.cast(eye, beside, max_range_m, ray, other, World::kStandingOnly)) {
      return std::nullopt;
    }
    edge[i] = other.range_m * beside - hit.range_m * d;
  }
  const Eigen::Vector3d normal = edge[0].cross(edge[1]).normalized();
  // What the two beams beside make of it must be what the world says: else they met something else.
  if (!normal.allFinite() || std::abs(std::abs(normal.dot(d)) - hit.cos_incidence) > kCosTolerance) {
    return std::nullopt;
  }
  return normal;
}

}  // namespace

TrueLocalisability true_localisability(const Scene& scene, double t_s) {
  const RangeErrors errors = range_errors_of(scene.drive());
  const geometry::Se3 T_world_lidar = scene.motion().pose_at(t_s) * scene.mounting().T_base_lidar;
  const Eigen::Vector3d& eye = T_world_lidar.translation();
  const double begin_s = std::max(0.0, t_s - kScan_s);
  const auto shots = static_cast<std::uint64_t>(kScan_s * scene.lidar().rate_hz());
  TrueLocalisability result;
  geometry::Matrix6d sum = geometry::Matrix6d::Zero();
  for (std::uint64_t i = 0; i < kBeams; ++i) {
    const Eigen::Vector3d d = T_world_lidar.rotation() * scene.lidar().beam(begin_s, i * shots / kBeams);
    Hit hit;
    if (!scene.world().cast(eye, d, errors.max_range_m, i, hit, World::kStandingOnly) ||
        hit.range_m < errors.min_range_m) {
      continue;
    }
    const double signal =
        static_cast<double>(hit.reflectivity) * hit.cos_incidence / (hit.range_m * hit.range_m * errors.full_signal);
    const auto normal = normal_at(scene.world(), eye, d, errors.max_range_m, i, hit);
    if (!normal) {
      continue;
    }
    geometry::Vector6d J;
    J << *normal, (hit.range_m * d).cross(*normal);
    sum += std::min(1.0, signal) * J * J.transpose();
    ++result.beams;
  }
  if (result.beams < 6) {
    return result;
  }
  const Eigen::Matrix3d turns = sum.bottomRightCorner<3, 3>() + 1e-9 * sum.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d position =
      sum.topLeftCorner<3, 3>() -
      sum.topRightCorner<3, 3>() * turns.ldlt().solve(Eigen::Matrix3d(sum.bottomLeftCorner<3, 3>()));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(position);
  const double all = solver.eigenvalues().sum();
  result.weakest = solver.eigenvectors().col(0);
  result.share = std::max(0.0, solver.eigenvalues()[0] / all);
  result.second = solver.eigenvalues()[1] / all;
  return result;
}

void write_localisability(const Scene& scene, const std::filesystem::path& file) {
  TextFile out(file);
  std::fprintf(out.stream(), "timestamp_ns,weakest_x,weakest_y,weakest_z,share,second_share,beams\n");
  for (double t_s = kScan_s; t_s <= scene.motion().duration_s(); t_s += kScan_s) {
    const TrueLocalisability found = true_localisability(scene, t_s);
    std::fprintf(out.stream(), "%lld,%.5f,%.5f,%.5f,%.6f,%.6f,%d\n",
                 static_cast<long long>(stamp_at(t_s).time_since_epoch().count()), found.weakest.x(), found.weakest.y(),
                 found.weakest.z(), found.share, found.second, found.beams);
  }
  out.close();
}

}  // namespace slamd::simulate
