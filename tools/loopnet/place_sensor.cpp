#include "tools/loopnet/place_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/base/units.hpp"
#include "tools/simulate/risley.hpp"

namespace slamd::loopnet {

namespace {

std::vector<double> even(double low_deg, double high_deg, std::size_t count) {
  std::vector<double> lines;
  for (std::size_t i = 0; i < count; ++i) {
    lines.push_back(kDegree * (low_deg + (high_deg - low_deg) * static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  return lines;
}

std::vector<double> lines_of(PlaceSensor::Kind kind, const simulate::Noise& noise) {
  switch (kind) {
    case PlaceSensor::Kind::kVlp16: return even(-15.0, 15.0, 16);
    case PlaceSensor::Kind::kHdl64: return even(-24.8, 2.0, 64);
    case PlaceSensor::Kind::kSpinning: break;
    case PlaceSensor::Kind::kAvia: return {};
  }
  constexpr std::array<std::size_t, 4> counts{16, 32, 64, 128};
  const double high_deg = noise.uniform(1, 2.0, 45.0);
  return even(-noise.uniform(2, 5.0, 45.0), high_deg, counts[static_cast<std::size_t>(4.0 * noise.uniform(3))]);
}

}  // namespace

PlaceSensor::PlaceSensor(Kind kind, const simulate::Noise& noise)
    : kind_(kind), noise_(noise), elevations_rad_(lines_of(kind, noise)) {}

void PlaceSensor::look(std::size_t count, std::uint64_t draw, std::vector<Eigen::Vector3d>& rays) const {
  rays.clear();
  const std::uint64_t number = 1000 + 8 * draw;
  if (kind_ == Kind::kAvia) {
    const auto phase = [&](std::uint64_t i) { return noise_.uniform(number + i, 0.0, 2.0 * M_PI); };
    const simulate::Risley pattern({phase(1), phase(2), phase(3)});
    for (std::size_t i = 0; i < count; ++i) {
      const double t_s = 0.1 * static_cast<double>(i) / static_cast<double>(count);
      rays.push_back(pattern.direction(t_s, static_cast<int>(i % 6)));
    }
    return;
  }
  const std::size_t columns = std::max<std::size_t>(1, count / elevations_rad_.size());
  const double phase = noise_.uniform(number, 0.0, 2.0 * M_PI);
  for (std::size_t column = 0; column < columns; ++column) {
    const double azimuth = phase + 2.0 * M_PI * static_cast<double>(column) / static_cast<double>(columns);
    for (const double elevation : elevations_rad_) {
      rays.emplace_back(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                        std::sin(elevation));
    }
  }
}

Eigen::Vector2d PlaceSensor::heights_m() const {
  return kind_ == Kind::kHdl64 ? Eigen::Vector2d(1.5, 2.0) : Eigen::Vector2d(0.5, 1.9);
}

PlaceSensor::Kind sensor_kind(const std::string& name) {
  const std::array<const char*, 4> names{"vlp16", "avia", "hdl64", "spinning"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (name == names[i]) {
      return static_cast<PlaceSensor::Kind>(i);
    }
  }
  throw std::invalid_argument(name + ": no such sensor");
}

}  // namespace slamd::loopnet
