#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "tools/simulate/bvh.hpp"
#include "tools/simulate/height_field.hpp"
#include "tools/simulate/mover.hpp"
#include "tools/simulate/noise.hpp"
#include "tools/simulate/surfaces.hpp"

namespace slamd::simulate {

/// A world of ground, boxes, cylinders, crowns and triangles in a tree of bounds, and of movers, for fast ray casting.
/// Frames: world, z up.  Units: m.
class World {
 public:
  /// `ground` gives the height at (x, y), steps (kerbs) only at the breaks; it is kept as patches of `spacing_m`.
  /// The ground spans [0, extent] in x and y.
  World(const std::function<double(double, double)>& ground, Eigen::Vector2d extent_m, std::uint64_t seed,
        const HeightField::Breaks& breaks = {}, double spacing_m = 1.0);

  void add(const OrientedBox& box) { boxes_.push_back(box); }
  void add(const Cylinder& cylinder) { cylinders_.push_back(cylinder); }
  void add(const Crown& crown) { crowns_.push_back(crown); }
  void add(const Triangle& triangle) { triangles_.push_back(triangle); }
  void add(Mover mover);

  /// The moment at which there are no movers.
  static constexpr double kStandingOnly = -1.0;

  /// Sorts everything into the tree; call it once, after the last add.
  void build();

  /// Casts a ray at a moment; `ray` numbers it, so that leaves are hit or missed the same way every time.
  /// Returns false when nothing is met within max_range_m.
  bool cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m, std::uint64_t ray,
            Hit& hit, double t_s = 0.0) const;

  /// The same by trying everything: what cast is tested against.
  bool cast_brute_force(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                        std::uint64_t ray, Hit& hit, double t_s = 0.0) const;

  double ground(double x, double y) const { return ground_.height(x, y); }
  const std::vector<OrientedBox>& boxes() const { return boxes_; }
  const std::vector<Cylinder>& cylinders() const { return cylinders_; }
  const std::vector<Crown>& crowns() const { return crowns_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<Mover>& movers() const { return movers_; }
  const Eigen::Vector2d& extent_m() const { return extent_m_; }

 private:
  enum class Kind : std::uint8_t { kBox, kCylinder, kCrown, kTriangle };
  struct Thing {
    Kind kind;
    std::uint32_t index;
  };

  Bounds bounds_of(const Thing& thing) const;
  void sort_things();
  void try_thing(std::uint32_t index, const Ray& ray, Hit& best) const;
  void try_movers(const Ray& ray, double t_s, Hit& best) const;

  HeightField ground_;
  Eigen::Vector2d extent_m_;
  Noise leaves_;
  std::vector<OrientedBox> boxes_;
  std::vector<Eigen::Vector2d> turns_;  // cosine and sine of each box's yaw
  std::vector<Cylinder> cylinders_;
  std::vector<Crown> crowns_;
  std::vector<Triangle> triangles_;
  std::vector<Mover> movers_;
  std::vector<double> mover_radius_m_;  // of a circle in the plan
  std::vector<Thing> things_;
  Bvh tree_;
};

}  // namespace slamd::simulate
