#pragma once

#include <random>

#include <Eigen/Core>

#include "core/geometry/se3.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::graph {

/// Draws what the tests of this folder need, from one seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}

  double normal(double std = 1.0) { return std * normal_(engine_); }
  double uniform(double low, double high) { return low + (high - low) * std::uniform_real_distribution<double>()(engine_); }
  Eigen::Vector3d vector(double std) { return {normal(std), normal(std), normal(std)}; }

  /// Positions of std_m an axis, turns of std_rad an axis.
  geometry::Se3 pose(double std_m, double std_rad) {
    const Eigen::Vector3d p = vector(std_m);
    return {geometry::so3_exp(vector(std_rad)), p};
  }

  /// A full, positive definite matrix with eigenvalues from about `least` on.
  template <int kN>
  Eigen::Matrix<double, kN, kN> positive(double least) {
    Eigen::Matrix<double, kN, kN> A;
    for (double& a : A.reshaped()) {
      a = normal();
    }
    return least * (Eigen::Matrix<double, kN, kN>::Identity() + A * A.transpose());
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace slamd::graph
