#pragma once

#include <cstdint>

#include "tools/simulate/motion.hpp"
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

/// Drives along a route: slower in bends, with a stop now and then.
Motion drive(const Route& route, const Ride& ride, std::uint64_t seed);

}  // namespace slamd::simulate
