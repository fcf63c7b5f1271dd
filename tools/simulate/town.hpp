#pragma once

#include <cstdint>

#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {

/// A town of streets on a jittered grid: façades with depth, kerbs, parked cars, poles, porous trees, fences, uneven
/// ground. Everything follows from the seed.
class Town : public Scenery {
 public:
  explicit Town(std::uint64_t seed) : Scenery(make_town(seed, {})) {}
};

}  // namespace slamd::simulate
