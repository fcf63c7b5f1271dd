#include "core/evaluation/nees.hpp"

#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

namespace slamd::evaluation {

namespace {

// χ² of six degrees of freedom at 0.025 and 0.975.
constexpr double kLow = 1.237344;
constexpr double kHigh = 14.449375;

}  // namespace

std::vector<double> relative_nees(std::span<const PosePair> pairs,
                                  std::span<const IndexPair> indices,
                                  std::span<const geometry::Matrix6d> covariances) {
  if (indices.size() != covariances.size()) {
    throw std::invalid_argument("there must be one covariance for each pair");
  }
  std::vector<double> values;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const PosePair& first = pairs[indices[k].first];
    const PosePair& second = pairs[indices[k].second];
    const geometry::Se3 reference = first.reference.inverse() * second.reference;
    const geometry::Se3 estimate = first.estimate.inverse() * second.estimate;
    const geometry::Vector6d e = geometry::boxminus(reference, estimate);
    const Eigen::LLT<geometry::Matrix6d> llt(covariances[k]);
    if (llt.info() != Eigen::Success) {
      throw std::invalid_argument("covariance " + std::to_string(k) + " is not positive definite");
    }
    values.push_back(e.dot(llt.solve(e)));
  }
  return values;
}

Consistency consistency_of(std::span<const double> nees) {
  Consistency result;
  result.count = nees.size();
  for (const double value : nees) {
    result.mean += value / static_cast<double>(nees.size());
    result.inside_95 +=
        value >= kLow && value <= kHigh ? 1.0 / static_cast<double>(nees.size()) : 0.0;
  }
  return result;
}

}  // namespace slamd::evaluation
