#include "drivers/recording/packet.hpp"
#include "tools/simulate/mesh_file.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {

namespace {

constexpr double kMargin_m = 1.0;
constexpr double kBelow_m = 1000.0;  // the world's own ground is out of sight

/// The lowest surface at a place: what is left when a plumb line has passed all others.
double lowest_surface(const World& world, double x, double y, double top) {
  double z = top;
  double lowest = 0.0;
  Hit hit;
  while (world.cast({x, y, z}, {0.0, 0.0, -1.0}, kBelow_m / 2.0, 0, hit)) {
    lowest = z - hit.range_m;
    z = lowest - 1e-3;
  }
  return lowest;
}

}  // namespace

Scenery make_mesh_world(const std::filesystem::path& file, std::uint64_t seed) {
  std::vector<Triangle> triangles = read_mesh(file);
  Bounds bounds;
  for (const Triangle& triangle : triangles) {
    for (const Eigen::Vector3f& corner : triangle.corners) {
      bounds.include({corner, corner});
    }
  }
  const Eigen::Vector3f shift(static_cast<float>(kMargin_m) - bounds.low.x(),
                              static_cast<float>(kMargin_m) - bounds.low.y(), -bounds.low.z());
  const Eigen::Vector3d size = (bounds.high - bounds.low).cast<double>();
  World world([](double, double) { return -kBelow_m; }, {size.x() + 2.0 * kMargin_m, size.y() + 2.0 * kMargin_m}, seed,
              {}, 16.0);
  for (Triangle& triangle : triangles) {
    for (Eigen::Vector3f& corner : triangle.corners) {
      corner += shift;
    }
    world.add(triangle);
  }
  world.build();
  // What is rolled on, on a grid: the tour asks for it often.
  const auto floor =
      std::make_shared<HeightField>([&](double x, double y) { return lowest_surface(world, x, y, size.z() + 1.0); },
                                    world.extent_m(), 0.5, HeightField::Breaks{});
  Route route;
  route.bend_m = 0.08 * std::min(size.x(), size.y());
  route.floor = [floor](double x, double y) { return floor->height(x, y); };
  // Without way-points: once around halfway between the middle and the edge.
  const Eigen::Vector2d middle = 0.5 * world.extent_m();
  const Eigen::Vector2d reach = 0.25 * size.head<2>();
  for (const auto& [x, y] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}}) {
    route.corners.emplace_back(middle.x() + x * reach.x(), middle.y() + y * reach.y());
  }
  return {std::move(world), std::move(route), seed};
}

}  // namespace slamd::simulate
