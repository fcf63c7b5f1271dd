#include "core/registration/gauss_newton.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "core/registration/association.hpp"

namespace slamd::registration {

namespace {

constexpr std::size_t kMinConstraints = 12;
constexpr double kConvergedStepSq = 1e-8;  // 0.1 mm and 0.1 mrad together

}  // namespace

geometry::Se3 align_to_surfaces(std::span<const Eigen::Vector3f> points_imu,
                                const map::VoxelMap& map,
                                const geometry::Se3& T_odom_imu_start,
                                const GaussNewtonConfig& config,
                                BoundedVector<Constraint>& scratch) {
  geometry::Se3 T_odom_imu = T_odom_imu_start;
  const float shrink = config.iterations < 2
                           ? 1.0F
                           : std::pow(config.gate_last_m / config.gate_first_m,
                                      1.0F / static_cast<float>(config.iterations - 1));
  float gate_m = config.gate_first_m;
  for (int i = 0; i < config.iterations; ++i, gate_m *= shrink) {
    const bool coarse = i < config.coarse_iterations;
    associate_surfaces(points_imu, map, coarse ? 1 : 0, gate_m, T_odom_imu, scratch);
    NormalEquations sum = linearize(scratch.view(), T_odom_imu, config.kernel_m);
    if (sum.count < kMinConstraints) {
      break;
    }
    sum.H.diagonal().array() += config.damping * sum.H.diagonal().maxCoeff();
    const geometry::Vector6d step = -sum.H.ldlt().solve(sum.g);
    T_odom_imu = geometry::boxplus(T_odom_imu, step);
    if (!coarse && step.squaredNorm() < kConvergedStepSq) {
      break;
    }
  }
  return T_odom_imu;
}

}  // namespace slamd::registration
