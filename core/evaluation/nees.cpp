#include "core/evaluation/nees.hpp"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace slamd::evaluation {

using geometry::Se3;
using geometry::Vector6d;

namespace {

// χ² at 0.95 of one, three and six degrees of freedom.
constexpr double kInside1 = 3.841459;
constexpr double kInside3 = 7.814728;
constexpr double kInside6 = 12.591587;

/// Returns the pair at a stamp, or nullptr.
const PosePair* at(std::span<const PosePair> pairs, Stamp stamp) {
  const auto pair = std::lower_bound(pairs.begin(), pairs.end(), stamp,
                                     [](const PosePair& p, Stamp wanted) { return p.stamp < wanted; });
  return pair != pairs.end() && pair->stamp == stamp ? &*pair : nullptr;
}

template <int kFirst, int kSize>
double nees_of(const MotionError& motion) {
  const Eigen::Matrix<double, kSize, 1> e = motion.error.segment<kSize>(kFirst);
  const Eigen::LLT<Eigen::Matrix<double, kSize, kSize>> llt(motion.covariance.block<kSize, kSize>(kFirst, kFirst));
  if (llt.info() != Eigen::Success) {
    throw std::invalid_argument("a covariance is not positive definite");
  }
  return e.dot(llt.solve(e));
}

/// Adds one of n values. The share counts them here: finish() divides, so that all of n is 1 to the last bit.
void add(Consistency& consistency, double nees, double inside, double n) {
  ++consistency.count;
  consistency.mean += nees / n;
  consistency.inside_95 += nees <= inside ? 1.0 : 0.0;
}

void finish(Consistency& consistency) {
  if (consistency.count > 0) {
    consistency.inside_95 /= static_cast<double>(consistency.count);
  }
}

}  // namespace

std::vector<MotionError> motion_errors(std::span<const PosePair> pairs, std::span<const MotionClaim> claims) {
  std::vector<MotionError> errors;
  for (const MotionClaim& claim : claims) {
    const PosePair* first = at(pairs, claim.first);
    const PosePair* last = at(pairs, claim.last);
    if (first == nullptr || last == nullptr) {
      continue;
    }
    const Se3 reference = first->reference.inverse() * last->reference;
    const Se3 estimate = first->estimate.inverse() * last->estimate;
    errors.push_back({geometry::boxminus(reference, estimate), claim.covariance});
  }
  return errors;
}

MotionConsistency consistency_of(std::span<const MotionError> errors) {
  MotionConsistency result;
  const auto n = static_cast<double>(errors.size());
  Vector6d error_squares = Vector6d::Zero();
  Vector6d variances = Vector6d::Zero();
  for (const MotionError& motion : errors) {
    add(result.pose, nees_of<0, 6>(motion), kInside6, n);
    add(result.position, nees_of<0, 3>(motion), kInside3, n);
    add(result.rotation, nees_of<3, 3>(motion), kInside3, n);
    for (int axis = 0; axis < 6; ++axis) {
      add(result.axes[static_cast<std::size_t>(axis)],
          motion.error[axis] * motion.error[axis] / motion.covariance(axis, axis), kInside1, n);
    }
    error_squares += motion.error.cwiseAbs2() / n;
    variances += motion.covariance.diagonal() / n;
  }
  for (Consistency* consistency : {&result.pose, &result.position, &result.rotation}) {
    finish(*consistency);
  }
  for (Consistency& axis : result.axes) {
    finish(axis);
  }
  result.error_rms = error_squares.cwiseSqrt();
  result.claimed_rms = variances.cwiseSqrt();
  return result;
}

}  // namespace slamd::evaluation
