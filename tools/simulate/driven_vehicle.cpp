#include "tools/simulate/driven_vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::simulate {

namespace {

constexpr int kSteps = 5;             // in each knot: a centimetre or two
constexpr double kLeft_m = 0.05;      // so far from a contact, the next one is another
constexpr double kLeft_rad = 0.05;
constexpr std::array<double, 3> kFeelers_m{0.25, 0.5, 0.8};  // above the floor: over kerbs, up to the sensor

double approached(double value, double wanted, double slower, double faster) {
  const bool speeds_up = wanted * value >= 0.0 && std::abs(wanted) > std::abs(value);
  const double step = speeds_up ? faster : slower;
  return value + std::clamp(wanted - value, -step, step);
}

}  // namespace

DrivenVehicle::DrivenVehicle(const World& world, const Route& route, const Ride& ride, const Place& start,
                             std::uint64_t seed)
    : world_(world), route_(route), body_(route, ride, seed), place_(start) {
  limits_.speed_mps = ride.speed_mps;
  limits_.turn_rate_radps = ride.turn_rate_radps;
}

Motion::Channels DrivenVehicle::advance(const Velocity& command, double t_s) {
  const Velocity wanted{std::clamp(command.v_mps, -limits_.speed_mps, limits_.speed_mps),
                        std::clamp(command.w_radps, -limits_.turn_rate_radps, limits_.turn_rate_radps)};
  for (int step = 0; step < kSteps; ++step) {
    move(wanted, Motion::kKnot_s / kSteps, t_s);
  }
  return body_.next(place_.position_m, place_.yaw_rad, way_m_, std::abs(velocity_.v_mps));
}

void DrivenVehicle::move(const Velocity& wanted, double dt_s, double t_s) {
  velocity_.v_mps = approached(velocity_.v_mps, wanted.v_mps, limits_.braking_mps2 * dt_s,
                               limits_.accelerating_mps2 * dt_s);
  velocity_.w_radps = approached(velocity_.w_radps, wanted.w_radps, limits_.turning_radps2 * dt_s,
                                 limits_.turning_radps2 * dt_s);
  const double yaw = place_.yaw_rad + 0.5 * velocity_.w_radps * dt_s;
  const Place next{place_.position_m + velocity_.v_mps * dt_s * Eigen::Vector2d(std::cos(yaw), std::sin(yaw)),
                   place_.yaw_rad + velocity_.w_radps * dt_s};
  if (!is_free(next, t_s)) {
    collisions_ += contact_ ? 0 : 1;
    contact_ = place_;
    velocity_ = {};
    return;
  }
  place_ = next;
  way_m_ += std::abs(velocity_.v_mps) * dt_s;
  if (contact_ && ((place_.position_m - contact_->position_m).norm() > kLeft_m ||
                   std::abs(place_.yaw_rad - contact_->yaw_rad) > kLeft_rad)) {
    contact_.reset();
  }
}

bool DrivenVehicle::is_free(const Place& place, double t_s) {
  const Eigen::Vector2d ahead(std::cos(place.yaw_rad), std::sin(place.yaw_rad));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  std::array<Eigen::Vector3d, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d p = place.position_m + (i == 0 || i == 3 ? 0.5 : -0.5) * limits_.length_m * ahead +
                              (i < 2 ? 0.5 : -0.5) * limits_.width_m * left;
    if ((p.array() < 0.0).any() || (p.array() > world_.extent_m().array()).any()) {
      return false;  // the end of the world
    }
    corners[i] = {p.x(), p.y(), route_.floor(p.x(), p.y())};
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d side = corners[(i + 1) % corners.size()] - corners[i];
    for (const double height : kFeelers_m) {
      Hit hit;
      if (world_.cast(corners[i] + height * Eigen::Vector3d::UnitZ(), side.normalized(), side.norm(), feeler_++, hit,
                      t_s)) {
        return false;
      }
    }
  }
  return true;
}

Place start_of(const Route& route, const Ride& ride, std::uint64_t seed) {
  Ride beginning = ride;
  beginning.duration_s = 1.0;
  const geometry::Se3 T = drive(route, beginning, seed).pose_at(0.0);
  return {T.translation().head<2>(), geometry::rpy_from_rotation(T.rotation()).z()};
}

}  // namespace slamd::simulate
