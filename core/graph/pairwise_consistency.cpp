#include "core/graph/pairwise_consistency.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/geometry/so3.hpp"

namespace slamd::graph {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

namespace {

/// closure is what should be the identity, twist the covariance of its error in the axes of its begin.
CycleError error_of(const Se3& closure, const Matrix6d& twist) {
  Vector6d e;
  e << closure.translation(), geometry::so3_log(closure.rotation());
  const Eigen::Matrix3d position = twist.topLeftCorner<3, 3>();
  return {e.dot(twist.ldlt().solve(e)),
          std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(position, Eigen::EigenvaluesOnly).eigenvalues()[2])};
}

Matrix6d carried(const Se3& T_a_b, const Matrix6d& twist_b) {
  const Matrix6d to_a = adjoint(T_a_b);
  return to_a * twist_b * to_a.transpose();
}

}  // namespace

CycleError odometry_cycle(const OdometryChain& chain, const ChainLoop& loop) {
  const Se3 T_j_i = chain.T_odom_base(loop.j).inverse() * chain.T_odom_base(loop.i);
  return error_of(loop.motion.T_a_b * T_j_i,
                  carried(loop.motion.T_a_b, right_twist_covariance(loop.motion) + chain.spread(loop.j, loop.i)));
}

CycleError pair_cycle(const OdometryChain& chain, const ChainLoop& first, const ChainLoop& second) {
  const Se3& T_i_j = first.motion.T_a_b;
  const Se3 T_j_l = chain.T_odom_base(first.j).inverse() * chain.T_odom_base(second.j);
  const Se3 T_k_i = chain.T_odom_base(second.i).inverse() * chain.T_odom_base(first.i);
  const Se3 T_i_l = T_i_j * T_j_l;
  const Se3 T_i_k = T_i_l * second.motion.T_a_b.inverse();
  const Matrix6d twist =
      carried(T_i_j, right_twist_covariance(first.motion) + chain.spread(first.j, second.j)) +
      carried(T_i_l, right_twist_covariance(second.motion)) + carried(T_i_k, chain.spread(second.i, first.i));
  return error_of(T_i_k * T_k_i, twist);
}

}  // namespace slamd::graph
