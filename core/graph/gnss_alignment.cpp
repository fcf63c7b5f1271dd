#include "core/graph/gnss_alignment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/assert.hpp"
#include "core/graph/chi_squared.hpp"
#include "core/graph/truncated_least_squares.hpp"

namespace slamd::graph {

namespace {

constexpr int kMaxRounds = 60;
constexpr double kMuStep = 1.4;

/// Horn's closed form for a yaw: the centroids meet, and the sum of cross and dot products gives the angle.
GnssAlignment fit_weighted(std::span<const AlignedPair> pairs, std::span<const double> weights) {
  Eigen::Vector3d mean_map = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_enu = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double w = weights[i] / (pairs[i].horizontal_std_m * pairs[i].horizontal_std_m);
    mean_map += w * pairs[i].p_map;
    mean_enu += w * pairs[i].p_enu;
    sum += w;
  }
  GnssAlignment out;
  if (!(sum > 0.0)) {
    return out;
  }
  mean_map /= sum;
  mean_enu /= sum;
  double cross = 0.0;
  double dot = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double w = weights[i] / (pairs[i].horizontal_std_m * pairs[i].horizontal_std_m);
    const Eigen::Vector3d m = pairs[i].p_map - mean_map;
    const Eigen::Vector3d e = pairs[i].p_enu - mean_enu;
    cross += w * (e.x() * m.y() - e.y() * m.x());
    dot += w * (e.x() * m.x() + e.y() * m.y());
  }
  out.yaw_rad = std::atan2(cross, dot);
  out.p_map_enu = mean_map - out.R_map_enu() * mean_enu;
  return out;
}

double chi_squared_of(const AlignedPair& pair, const GnssAlignment& alignment) {
  const Eigen::Vector3d r = pair.p_map - alignment * pair.p_enu;
  return r.head<2>().squaredNorm() / (pair.horizontal_std_m * pair.horizontal_std_m) +
         r.z() * r.z() / (pair.vertical_std_m * pair.vertical_std_m);
}

void measure(std::span<const AlignedPair> pairs, std::span<const double> weights, AlignmentEstimate& out) {
  double information = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double sum = 0.0;
  const AlignedPair* first = nullptr;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double w = weights[i] / (pairs[i].horizontal_std_m * pairs[i].horizontal_std_m);
    mean += w * pairs[i].p_map.head<2>();
    sum += w;
    if (weights[i] > 0.5) {
      first = first == nullptr ? &pairs[i] : first;
      out.extent_m = std::max(out.extent_m, (pairs[i].p_map - first->p_map).head<2>().norm());
    }
  }
  if (sum > 0.0) {
    mean /= sum;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double w = weights[i] / (pairs[i].horizontal_std_m * pairs[i].horizontal_std_m);
    information += w * (pairs[i].p_map.head<2>() - mean).squaredNorm();
  }
  out.yaw_std_rad = information > 0.0 ? 1.0 / std::sqrt(information) : M_PI;
}

}  // namespace

Eigen::Matrix3d GnssAlignment::R_map_enu() const {
  return Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

GnssAlignment boxplus(const GnssAlignment& alignment, const Vector4d& delta) {
  return {alignment.yaw_rad + delta[3], alignment.p_map_enu + delta.head<3>()};
}

AlignmentEstimate fit_alignment(std::span<const AlignedPair> pairs, std::span<double> weights) {
  SLAMD_ASSERT(weights.size() == pairs.size());
  std::fill(weights.begin(), weights.end(), 1.0);
  AlignmentEstimate out;
  out.alignment = fit_weighted(pairs, weights);
  double worst = 0.0;
  for (const AlignedPair& pair : pairs) {
    worst = std::max(worst, chi_squared_of(pair, out.alignment) / kChiSquared99Of3);
  }
  double mu = first_mu(worst);
  for (int round = 0; round < kMaxRounds && worst > 1.0; ++round, mu *= kMuStep) {
    bool settled = true;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      weights[i] = truncated_weight(chi_squared_of(pairs[i], out.alignment) / kChiSquared99Of3, mu);
      settled = settled && (weights[i] == 0.0 || weights[i] == 1.0);
    }
    out.alignment = fit_weighted(pairs, weights);
    if (settled) {
      break;
    }
  }
  measure(pairs, weights, out);
  return out;
}

}  // namespace slamd::graph
