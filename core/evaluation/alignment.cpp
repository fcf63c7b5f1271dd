#include "core/evaluation/alignment.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/SVD>

#include "core/geometry/so3.hpp"

namespace slamd::evaluation {

namespace {

struct Moments {
  Eigen::Vector3d reference_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // Σ (y − ȳ)(x − x̄)ᵀ / n
  double estimate_variance = 0.0;
};

Moments moments_of(std::span<const PosePair> pairs) {
  Moments moments;
  const double n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    moments.reference_mean += pair.reference.translation() / n;
    moments.estimate_mean += pair.estimate.translation() / n;
  }
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d y = pair.reference.translation() - moments.reference_mean;
    const Eigen::Vector3d x = pair.estimate.translation() - moments.estimate_mean;
    moments.covariance += y * x.transpose() / n;
    moments.estimate_variance += x.squaredNorm() / n;
  }
  return moments;
}

Similarity umeyama(const Moments& moments, bool with_scale) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moments.covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& d = svd.singularValues();
  if (!(d[1] > std::numeric_limits<double>::epsilon())) {
    throw std::invalid_argument("the poses lie on a line: no rotation can be found; align by yaw or origin");
  }
  Eigen::Vector3d s = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) {
    s[2] = -1.0;
  }
  Similarity result;
  const Eigen::Matrix3d R = svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
  result.scale = with_scale ? d.dot(s) / moments.estimate_variance : 1.0;
  result.T_reference_estimate =
      geometry::Se3(R, moments.reference_mean - result.scale * (R * moments.estimate_mean));
  return result;
}

Similarity yaw_only(const Moments& moments) {
  // Maximises tr(Rz(ψ)ᵀ Σ).
  const double yaw = std::atan2(moments.covariance(1, 0) - moments.covariance(0, 1),
                                moments.covariance(0, 0) + moments.covariance(1, 1));
  const Eigen::Matrix3d R = geometry::rotation_from_rpy({0.0, 0.0, yaw});
  return {geometry::Se3(R, moments.reference_mean - R * moments.estimate_mean), 1.0};
}

}  // namespace

Similarity align(std::span<const PosePair> pairs, Alignment alignment, std::size_t count) {
  if (pairs.empty()) {
    throw std::invalid_argument("no poses in common");
  }
  const std::span<const PosePair> used = count == 0 || count > pairs.size() ? pairs : pairs.first(count);
  switch (alignment) {
    case Alignment::kNone: return {};
    case Alignment::kSe3: return umeyama(moments_of(used), false);
    case Alignment::kSim3: return umeyama(moments_of(used), true);
    case Alignment::kYaw: return yaw_only(moments_of(used));
    case Alignment::kOrigin: return {pairs[0].reference * pairs[0].estimate.inverse(), 1.0};
  }
  return {};
}

}  // namespace slamd::evaluation
