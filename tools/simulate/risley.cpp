#include "tools/simulate/risley.hpp"

#include <cmath>

namespace slamd::simulate {

namespace {

constexpr std::array<double, 3> kRates_hz{-131.3426, 40.7377, 212.818};
constexpr std::array<double, 3> kRepetitiveRates_hz{-110.0, 110.0, 330.0};  // the third as above: |first| + 2 second
constexpr double kWedges_deg[3] = {30.8856, 29.7735, 3.1351};
constexpr double kIndex = 1.51;
constexpr double kBeams[6] = {-0.0521607, -0.03238, -0.01080, 0.01080, 0.03238, 0.0521607};

/// Snell's law in vector form; ratio = n_from / n_to, N against the ray.
Eigen::Vector3d refracted(const Eigen::Vector3d& b, const Eigen::Vector3d& N, double ratio) {
  const double c_in = -b.dot(N);
  const double c_out = std::sqrt(1.0 - ratio * ratio * (1.0 - c_in * c_in));
  return (ratio * b + (ratio * c_in - c_out) * N).normalized();
}

}  // namespace

Risley::Risley(const std::array<double, 3>& phases_rad, RisleyPattern pattern)
    : phases_rad_(phases_rad), rates_hz_(pattern == RisleyPattern::kRepetitive ? kRepetitiveRates_hz : kRates_hz) {}

Eigen::Vector3d Risley::direction(double t_s, int line) const {
  Eigen::Vector3d b(kBeams[line], std::sqrt(1.0 - kBeams[line] * kBeams[line]), 0.0);
  const Eigen::Vector3d exit(0.0, -1.0, 0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const double w = 2.0 * M_PI * rates_hz_[k] * t_s + phases_rad_[k];
    static const double sines[3] = {std::sin(kWedges_deg[0] * M_PI / 180.0), std::sin(kWedges_deg[1] * M_PI / 180.0),
                                    std::sin(kWedges_deg[2] * M_PI / 180.0)};
    static const double cosines[3] = {std::cos(kWedges_deg[0] * M_PI / 180.0), std::cos(kWedges_deg[1] * M_PI / 180.0),
                                      std::cos(kWedges_deg[2] * M_PI / 180.0)};
    const Eigen::Vector3d entry(std::sin(w) * sines[k], -cosines[k], std::cos(w) * sines[k]);
    b = refracted(b, entry, 1.0 / kIndex);
    b = refracted(b, exit, kIndex);
  }
  return {b.y(), -b.z(), b.x()};
}

}  // namespace slamd::simulate
