#include "tools/simulate/beam.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace slamd::simulate {

namespace {

constexpr double kPulse_m = 0.45;      // nearer echoes of one shot melt into one
constexpr double kDropsSeen_m = 25.0;  // drops farther away are too faint

Echo echo_of(const Hit& hit, double share) {
  Echo echo;
  echo.range_m = hit.range_m;
  echo.signal = share * static_cast<double>(hit.reflectivity) * hit.cos_incidence / (hit.range_m * hit.range_m);
  echo.reflectivity = hit.reflectivity;
  return echo;
}

}  // namespace

void Echoes::add(const Echo& found) {
  if (count == static_cast<int>(echo.size())) {
    return;
  }
  int place = count++;
  for (; place > 0 && echo[static_cast<std::size_t>(place) - 1].range_m > found.range_m; --place) {
    echo[static_cast<std::size_t>(place)] = echo[static_cast<std::size_t>(place) - 1];
  }
  echo[static_cast<std::size_t>(place)] = found;
}

const Echo* Echoes::strongest() const {
  const Echo* best = nullptr;
  for (int i = 0; i < count; ++i) {
    const Echo& candidate = echo[static_cast<std::size_t>(i)];
    best = best == nullptr || candidate.signal > best->signal ? &candidate : best;
  }
  return best;
}

void Beam::add_surfaces(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_s,
                        std::uint64_t number, Echoes& echoes) const {
  Hit hit;
  const bool any = world_.cast(origin, direction, errors_.max_range_m, number, hit, t_s);
  if (!errors_.mixed_pixels) {
    if (any) {
      echoes.add(echo_of(hit, 1.0));
    }
    return;
  }
  // A second ray somewhere in the beam's width, with a share of its light.
  const double angle = noise_.uniform(8 * number + 6, 0.0, 2.0 * M_PI);
  const double radius = 0.5 * errors_.divergence_rad * std::sqrt(noise_.uniform(8 * number + 7));
  const Eigen::Vector3d side =
      direction.cross(std::abs(direction.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX()).normalized();
  const Eigen::Vector3d up = side.cross(direction);
  const Eigen::Vector3d beside = (direction + radius * (std::cos(angle) * side + std::sin(angle) * up)).normalized();
  const double share = noise_.uniform(8 * number + 1, 0.5, 1.0);
  Hit other;
  const bool any_other = world_.cast(origin, beside, errors_.max_range_m, number, other, t_s);
  const bool same_surface = any && any_other && std::abs(hit.cos_incidence - other.cos_incidence) < 0.02 &&
                            std::abs(hit.reflectivity - other.reflectivity) < 1e-6F &&
                            std::abs(hit.range_m - other.range_m) < kPulse_m;
  if (same_surface) {
    echoes.add(echo_of(hit, 1.0));
  } else if (any && any_other && std::abs(hit.range_m - other.range_m) < kPulse_m) {
    const Echo a = echo_of(hit, share);
    const Echo b = echo_of(other, 1.0 - share);
    Echo melted = a;
    melted.signal = a.signal + b.signal;
    melted.range_m = (a.signal * a.range_m + b.signal * b.range_m) / melted.signal;
    melted.mixed = true;
    echoes.add(melted);
  } else {
    if (any) {
      echoes.add(echo_of(hit, share));
    }
    if (any_other) {
      echoes.add(echo_of(other, 1.0 - share));
    }
  }
}

void Beam::add_air(std::uint64_t number, Echoes& echoes) const {
  const double range = -std::log(1.0 - noise_.uniform(8 * number)) / errors_.drops_per_m;
  const double end = echoes.count > 0 ? echoes.echo[0].range_m : errors_.max_range_m;
  if (range < std::min(end, kDropsSeen_m)) {
    Echo drop;
    drop.range_m = range;
    drop.signal = noise_.uniform(8 * number + 4, 0.0, 0.25) / (range * range);
    drop.reflectivity = 0.03F;
    drop.air = true;
    echoes.add(drop);
  }
}

Echoes Beam::shoot(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_s, std::uint64_t number,
                   double bias_m) const {
  Echoes seen;
  add_surfaces(origin, direction, t_s, number, seen);
  if (errors_.drops_per_m > 0.0) {
    add_air(number, seen);
  }
  Echoes heard;
  for (int i = 0; i < seen.count; ++i) {
    Echo echo = seen.echo[static_cast<std::size_t>(i)];
    const auto place = static_cast<std::uint64_t>(i) << 50;
    // What comes back falls with the square of the range; grazing and dark surfaces vanish first.
    const double chance = std::clamp(echo.signal / errors_.full_signal, 0.0, 1.0);
    if (echo.range_m < errors_.min_range_m || noise_.uniform(place + 8 * number + 5) > chance) {
      continue;
    }
    echo.range_m += bias_m + errors_.noise_m * noise_.normal(place + 4 * number + 1);
    heard.add(echo);
  }
  return heard;
}

}  // namespace slamd::simulate
