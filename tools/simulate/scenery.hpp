#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tools/simulate/route.hpp"
#include "tools/simulate/vehicle.hpp"
#include "tools/simulate/world.hpp"

namespace slamd::simulate {

/// A world and the tour through it.
class Scenery {
 public:
  Scenery(World world, Route route, std::uint64_t seed)
      : world_(std::move(world)), route_(std::move(route)), seed_(seed) {}
  virtual ~Scenery() = default;
  Scenery(const Scenery&) = delete;
  Scenery& operator=(const Scenery&) = delete;
  Scenery(Scenery&&) = default;
  Scenery& operator=(Scenery&&) = default;

  const World& world() const { return world_; }
  const Route& route() const { return route_; }
  std::uint64_t seed() const { return seed_; }

  /// Replaces the tour's corners.
  void set_corners(std::vector<Eigen::Vector2d> corners) { route_.corners = std::move(corners); }

  /// Returns a tour of a car that comes back to where it began, as long as asked for.
  /// `height_m` is base above the floor.
  Motion tour(double duration_s, double speed_mps, double rest_s, double height_m) const {
    Ride ride;
    ride.duration_s = duration_s;
    ride.speed_mps = speed_mps;
    ride.rest_s = rest_s;
    ride.height_m = height_m;
    return drive(route_, ride, seed_);
  }

 private:
  World world_;
  Route route_;
  std::uint64_t seed_;
};

/// What a world may hold beside what stands.
struct Extras {
  int cars = 0;
  int people = 0;
};

/// The names of the worlds that a seed can make.
const std::vector<std::string>& world_names();

/// Makes a world by name. Errors: std::invalid_argument for a name that is none.
std::unique_ptr<Scenery> make_scenery(const std::string& name, std::uint64_t seed, const Extras& extras);

Scenery make_town(std::uint64_t seed, const Extras& extras);
Scenery make_campus(std::uint64_t seed, const Extras& extras);
Scenery make_indoor(std::uint64_t seed, const Extras& extras);
Scenery make_tunnel(std::uint64_t seed, const Extras& extras);
Scenery make_warehouse(std::uint64_t seed, const Extras& extras);
Scenery make_harbour(std::uint64_t seed, const Extras& extras);

/// Loads a mesh as a world, moved so that it begins at (0, 0). The vehicle rolls on its lowest surface.
/// Errors: RecordingError.
Scenery make_mesh_world(const std::filesystem::path& file, std::uint64_t seed);

/// Lets cars and people go along a closed line, a little beside it and each at its own pace.
void add_traffic(World& world, const std::vector<Eigen::Vector2d>& corners, const Extras& extras, const Noise& noise);

}  // namespace slamd::simulate
