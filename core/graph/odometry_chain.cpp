#include "core/graph/odometry_chain.hpp"

#include "core/base/assert.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::graph {

using geometry::Matrix6d;
using geometry::Se3;

Matrix6d adjoint(const Se3& T_a_b) {
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = T_a_b.rotation();
  out.topRightCorner<3, 3>() = geometry::skew(T_a_b.translation()) * T_a_b.rotation();
  out.bottomRightCorner<3, 3>() = T_a_b.rotation();
  return out;
}

Matrix6d right_twist_covariance(const Motion& motion) {
  Matrix6d turn = Matrix6d::Identity();
  turn.topLeftCorner<3, 3>() = motion.T_a_b.rotation().transpose();
  return turn * motion.covariance * turn.transpose();
}

Matrix6d covariance_from_left_twist(const Se3& T_a_b, const Matrix6d& twist) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -geometry::skew(T_a_b.translation());
  J.bottomRightCorner<3, 3>() = T_a_b.rotation().transpose();
  return J * twist * J.transpose();
}

Motion composed(const Motion& a_b, const Motion& b_c) {
  Motion out;
  out.T_a_b = a_b.T_a_b * b_c.T_a_b;
  const Matrix6d to_a = adjoint(a_b.T_a_b);
  const Matrix6d to_a_from_c = adjoint(out.T_a_b);
  const Matrix6d twist = to_a * right_twist_covariance(a_b) * to_a.transpose() +
                         to_a_from_c * right_twist_covariance(b_c) * to_a_from_c.transpose();
  out.covariance = covariance_from_left_twist(out.T_a_b, twist);
  return out;
}

Motion inverse(const Motion& a_b) {
  // T Exp(ξ) inverted is Exp(−ξ) T⁻¹: what was on the right is on the left.
  const Se3 T_b_a = a_b.T_a_b.inverse();
  return {T_b_a, covariance_from_left_twist(T_b_a, right_twist_covariance(a_b))};
}

void OdometryChain::push_back(const Se3& T_odom_base, const Matrix6d& covariance) {
  Link link;
  link.T_odom_base = T_odom_base;
  if (!links_.empty()) {
    const Motion motion{links_.back().T_odom_base.inverse() * T_odom_base, covariance};
    const Matrix6d to_odom = adjoint(T_odom_base);
    link.sum_odom = links_.back().sum_odom + to_odom * right_twist_covariance(motion) * to_odom.transpose();
  }
  links_.push_back(link);
}

void OdometryChain::erase(std::size_t i) {
  SLAMD_ASSERT(i < links_.size());
  for (std::size_t k = i + 1; k < links_.size(); ++k) {
    links_[k - 1] = links_[k];
  }
  links_.resize(links_.size() - 1);
}

Matrix6d OdometryChain::spread(std::size_t i, std::size_t j) const {
  const Matrix6d to_base = adjoint(links_[i].T_odom_base.inverse());
  const Matrix6d sum = i < j ? links_[j].sum_odom - links_[i].sum_odom : links_[i].sum_odom - links_[j].sum_odom;
  return to_base * sum * to_base.transpose();
}

Motion OdometryChain::between(std::size_t i, std::size_t j) const {
  SLAMD_ASSERT(i < j && j < links_.size());
  const Se3 T_i_j = links_[i].T_odom_base.inverse() * links_[j].T_odom_base;
  return {T_i_j, covariance_from_left_twist(T_i_j, spread(i, j))};
}

}  // namespace slamd::graph
