#include "core/geometry/se3.hpp"

#include "core/geometry/so3.hpp"

namespace slamd::geometry {

Se3 boxplus(const Se3& T, const Vector6d& delta) {
  return {T.rotation() * so3_exp(delta.tail<3>()), T.translation() + delta.head<3>()};
}

Vector6d boxminus(const Se3& a, const Se3& b) {
  Vector6d delta;
  delta.head<3>() = a.translation() - b.translation();
  delta.tail<3>() = so3_log(b.rotation().transpose() * a.rotation());
  return delta;
}

Se3 interpolate(const Se3& a, const Se3& b, double ratio) {
  return {a.rotation() * so3_exp(ratio * so3_log(a.rotation().transpose() * b.rotation())),
          (1.0 - ratio) * a.translation() + ratio * b.translation()};
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return so3_log(a.transpose() * b).norm();
}

}  // namespace slamd::geometry
