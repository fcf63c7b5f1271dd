#include "tools/simulate/scenery.hpp"

#include <stdexcept>

namespace slamd::simulate {

namespace {

/// A closed line that runs beside another one, on its right.
std::vector<Eigen::Vector2d> beside(const std::vector<Eigen::Vector2d>& corners, double right_m) {
  std::vector<Eigen::Vector2d> line;
  const std::size_t count = corners.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d in = (corners[i] - corners[(i + count - 1) % count]).normalized();
    const Eigen::Vector2d out = (corners[i + 1] - corners[i]).normalized();
    const Eigen::Vector2d right_in(in.y(), -in.x());
    const Eigen::Vector2d right_out(out.y(), -out.x());
    const Eigen::Vector2d sum = right_in + right_out;
    const double length = sum.squaredNorm();
    line.push_back(corners[i] + (length > 0.3 ? Eigen::Vector2d(2.0 * right_m / length * sum)
                                              : Eigen::Vector2d(right_m * right_in)));
  }
  return line;
}

}  // namespace

const std::vector<std::string>& world_names() {
  static const std::vector<std::string> names{"town", "campus", "indoor", "tunnel", "warehouse", "harbour"};
  return names;
}

std::unique_ptr<Scenery> make_scenery(const std::string& name, std::uint64_t seed, const Extras& extras) {
  using Make = Scenery (*)(std::uint64_t, const Extras&);
  const std::vector<std::pair<std::string, Make>> makers{{"town", make_town},           {"campus", make_campus},
                                                         {"indoor", make_indoor},       {"tunnel", make_tunnel},
                                                         {"warehouse", make_warehouse}, {"harbour", make_harbour}};
  for (const auto& [known, make] : makers) {
    if (known == name) {
      return std::make_unique<Scenery>(make(seed, extras));
    }
  }
  throw std::invalid_argument(name + ": no such world");
}

void add_traffic(World& world, const std::vector<Eigen::Vector2d>& corners, const Extras& extras, const Noise& noise) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    length += (corners[i + 1] - corners[i]).norm();
  }
  for (int i = 0; i < extras.cars + extras.people; ++i) {
    const auto number = static_cast<std::uint64_t>(5000 + 10 * i);
    const bool car = i < extras.cars;
    // Half of the people come towards the vehicle, and all cars.
    const bool against = car || noise.uniform(number) < 0.5;
    std::vector<Eigen::Vector2d> line = corners;
    if (against) {
      std::reverse(line.begin(), line.end());
    }
    Mover mover;
    mover.path = sampled(beside(line, car ? 2.0 : noise.uniform(number + 1, 0.9, 1.6)));
    mover.boxes = car ? car_boxes() : person_boxes();
    mover.speed_mps = car ? noise.uniform(number + 2, 4.0, 9.0) : noise.uniform(number + 2, 0.7, 1.6);
    mover.start_m = noise.uniform(number + 3, 0.0, length);
    world.add(std::move(mover));
  }
}

}  // namespace slamd::simulate
