#include "tools/loopnet/place_world.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tools/simulate/scenery.hpp"

namespace slamd::loopnet {

namespace {

bool is_indoor(const std::string& name) { return name == "indoor" || name == "warehouse" || name == "tunnel"; }

/// A world of slamd-simulate with its tour as lanes.
PlaceWorld make_simulated(const std::string& name, std::uint64_t seed) {
  std::unique_ptr<simulate::Scenery> scenery = simulate::make_scenery(name, seed, {3, 6});
  const simulate::Route route = scenery->route();
  std::vector<std::vector<Eigen::Vector2d>> lanes;
  for (std::size_t i = 0; i + 1 < route.corners.size(); ++i) {
    lanes.push_back({route.corners[i], route.corners[i + 1]});
  }
  return {scenery->world(), std::move(lanes), route.floor, is_indoor(name)};
}

}  // namespace

const std::vector<std::string>& place_world_names() {
  static const std::vector<std::string> names{"streets", "grounds", "floors",    "town",
                                              "campus",  "indoor",  "warehouse", "harbour"};
  return names;
}

PlaceWorld make_place_world(const std::string& name, std::uint64_t seed) {
  using Make = PlaceWorld (*)(std::uint64_t);
  const std::vector<std::pair<std::string, Make>> makers{
      {"streets", make_streets}, {"grounds", make_grounds}, {"floors", make_floors}};
  for (const auto& [known, make] : makers) {
    if (known == name) {
      return make(seed);
    }
  }
  const std::vector<std::string>& names = place_world_names();
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw std::invalid_argument(name + ": no such world");
  }
  return make_simulated(name, seed);
}

void add_passers_by(PlaceWorld& place_world, const simulate::Noise& noise, int cars, int people) {
  for (int i = 0; i < cars + people; ++i) {
    const auto number = static_cast<std::uint64_t>(900'000 + 10 * i);
    const bool car = i < cars;
    const auto lane = static_cast<std::size_t>(noise.uniform(number) * static_cast<double>(place_world.lanes.size()));
    std::vector<Eigen::Vector2d> corners = place_world.lanes[lane];
    const double side_m = car ? noise.uniform(number + 1, 1.8, 3.4) : noise.uniform(number + 1, 0.6, 2.2);
    // Out on one side, back on the other: it is far enough from the vehicle's own line.
    std::vector<Eigen::Vector2d> there;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d ahead =
          (corners[std::min(k + 1, corners.size() - 1)] - corners[k > 0 ? k - 1 : 0]).normalized();
      there.push_back(corners[k] + side_m * Eigen::Vector2d(ahead.y(), -ahead.x()));
      corners[k] -= side_m * Eigen::Vector2d(ahead.y(), -ahead.x());
    }
    there.insert(there.end(), corners.rbegin(), corners.rend());
    simulate::Mover mover;
    mover.path = simulate::sampled(there);
    mover.boxes = car ? simulate::car_boxes() : simulate::person_boxes();
    mover.speed_mps = 1.0;
    mover.start_m = noise.uniform(number + 2, 0.0, 1000.0);
    place_world.world.add(std::move(mover));
  }
}

}  // namespace slamd::loopnet
