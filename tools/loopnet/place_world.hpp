#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/world.hpp"

namespace slamd::loopnet {

/// A world in which places are visited: where a vehicle may be, and what is close there.
/// Frames: world, z up.  Units: m.
struct PlaceWorld {
  simulate::World world;
  std::vector<std::vector<Eigen::Vector2d>> lanes;  // polylines along which vehicles go
  std::function<double(double, double)> floor;      // height of what wheels roll on
  bool indoor = false;                              // places are a few metres apart, not tens
};

/// The worlds that Loop-Net learns from. The first three are made for it: nothing of their layout is the same in two seeds.
/// The others are slamd-simulate's.
const std::vector<std::string>& place_world_names();

/// Makes a world by name. Errors: std::invalid_argument for a name that is none.
PlaceWorld make_place_world(const std::string& name, std::uint64_t seed);

PlaceWorld make_streets(std::uint64_t seed);
PlaceWorld make_grounds(std::uint64_t seed);
PlaceWorld make_floors(std::uint64_t seed);

/// Adds cars and people that are elsewhere at each visit.
void add_passers_by(PlaceWorld& place_world, const simulate::Noise& noise, int cars, int people);

}  // namespace slamd::loopnet
