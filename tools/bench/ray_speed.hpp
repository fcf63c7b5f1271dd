#pragma once

#include <cstdint>
#include <string>

namespace slamd::bench {

/// How fast a world's rays are cast on one core.  Units: millions a second.
struct RaySpeed {
  double caster = 0.0;  // World::cast alone, in a VLP-16's directions along the tour
  double packets = 0.0;  // whole packets: motion, losses, noise, bytes
};

/// Measures `seconds` of CPU time of each.
RaySpeed measure_ray_speed(const std::string& world, std::uint64_t seed, double seconds);

}  // namespace slamd::bench
