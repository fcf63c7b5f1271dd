#pragma once

#include <cstdint>

#include "tools/simulate/motion.hpp"
#include "tools/simulate/noise.hpp"
#include "tools/simulate/route.hpp"

namespace slamd::simulate {

enum class VehicleKind {
  kAckermann,  // bends of a few metres, never on the spot
  kSkidSteer,  // stops at every second corner and turns on the spot
  kHandheld,   // carried by somebody in a hurry
};

/// How a tour is driven.
struct Ride {
  VehicleKind vehicle = VehicleKind::kAckermann;
  double duration_s = 60.0;
  double speed_mps = 1.6;
  double rest_s = 3.0;              // standing still at the start
  double height_m = 0.45;           // of base above the floor
  double turn_rate_radps = 2.0944;  // on the spot: 120 °/s
  double bumps_per_100m = 0.0;      // cable ramps of 5 cm
  double vibration_mps2 = 0.0;      // of the engine and the wheels, rms while moving
};

/// A body on its wheels: it follows the slope of the floor with a lag; the road shakes it a little while it moves.
class Body {
 public:
  Body(const Route& route, const Ride& ride, std::uint64_t seed)
      : route_(route), height_m_(ride.height_m), bumps_per_100m_(ride.bumps_per_100m), bumps_(seed, 3) {}

  /// Returns the motion's next control point: of a vehicle at a place, which looks along yaw and has gone way_m.
  Motion::Channels next(const Eigen::Vector2d& p, double yaw, double way_m, double speed_mps);

 private:
  const Route& route_;
  double height_m_;
  double bumps_per_100m_;
  Noise bumps_;
  std::uint64_t number_ = 0;
  double pitch_ = 0.0;
  double roll_ = 0.0;
};

/// Drives along a route: slower in bends, with a stop now and then.
Motion drive(const Route& route, const Ride& ride, std::uint64_t seed);

/// A motion that stands still at a control point, and can be appended to.
Motion standing(const Motion::Channels& there, const Ride& ride, std::uint64_t seed);

/// How much a body shakes at a speed: of its vibration, and of what the road does to it.
double shake_of(double speed_mps);

}  // namespace slamd::simulate
