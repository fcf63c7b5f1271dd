#pragma once

#include <cstdint>
#include <optional>

#include "tools/simulate/vehicle.hpp"
#include "tools/simulate/world.hpp"

namespace slamd::simulate {

/// How a vehicle shall move.  Units: m/s ahead, rad/s to the left.
struct Velocity {
  double v_mps = 0.0;
  double w_radps = 0.0;
};

/// What a skid-steered vehicle can do, and how large it is.
struct SkidSteer {
  double speed_mps = 1.6;
  double turn_rate_radps = 2.0944;
  double accelerating_mps2 = 0.8;
  double braking_mps2 = 1.5;
  double turning_radps2 = 4.0;
  double length_m = 0.8;
  double width_m = 0.66;
};

/// Where a vehicle stands on the ground.  Frames: world.
struct Place {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
};

/// A skid-steered vehicle that follows velocity commands as fast as it can, and stops where it meets the world.
class DrivenVehicle {
 public:
  DrivenVehicle(const World& world, const Route& route, const Ride& ride, const Place& start, std::uint64_t seed);

  /// Drives for kKnot_s from t_s on (movers are where they are then); returns the motion's next control point.
  Motion::Channels advance(const Velocity& command, double t_s);

  const Place& place() const { return place_; }
  const Velocity& velocity() const { return velocity_; }
  const SkidSteer& limits() const { return limits_; }

  /// How often it has met the world.
  std::uint32_t collisions() const { return collisions_; }

 private:
  void move(const Velocity& wanted, double dt_s, double t_s);
  bool is_free(const Place& place, double t_s);

  const World& world_;
  const Route& route_;
  SkidSteer limits_;
  Body body_;
  Place place_;
  Velocity velocity_;
  double way_m_ = 0.0;
  std::uint32_t collisions_ = 0;
  std::optional<Place> contact_;  // of the last collision, until it has left it behind
  std::uint64_t feeler_ = 0;      // number of the next ray
};

/// Where a tour begins.
Place start_of(const Route& route, const Ride& ride, std::uint64_t seed);

}  // namespace slamd::simulate
