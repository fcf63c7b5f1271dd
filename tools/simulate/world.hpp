#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// What a surface is made of, as far as a LiDAR can tell: share of the light that comes back.
using Reflectivity = float;

/// A box that stands upright, turned about the vertical.
struct OrientedBox {
  Eigen::Vector3d centre;
  Eigen::Vector3d half;
  double yaw_rad = 0.0;
  Reflectivity reflectivity = 0.4F;
};

/// An upright cylinder: poles and trunks.
struct Cylinder {
  Eigen::Vector2d centre;
  double radius = 0.1;
  double bottom = 0.0;
  double top = 5.0;
  Reflectivity reflectivity = 0.4F;
};

/// A tree's crown: a ball of leaves that lets a part of the light through.
struct Crown {
  Eigen::Vector3d centre;
  double radius = 2.0;
  double free_path_m = 1.2;  // mean length of a ray between leaves
  Reflectivity reflectivity = 0.25F;
};

/// Where a ray ends.
struct Hit {
  double range_m = 0.0;
  double cos_incidence = 1.0;
  Reflectivity reflectivity = 0.0F;
};

/// A static world of ground, boxes, cylinders and crowns, with a grid over the plan for fast ray casting.
/// Frames: world, z up.  Units: m.
class World {
 public:
  /// `ground` gives the height at (x, y); it may have steps (kerbs). The world spans [0, extent] in x and y.
  World(std::function<double(double, double)> ground, Eigen::Vector2d extent_m, std::uint64_t seed);

  void add(const OrientedBox& box);
  void add(const Cylinder& cylinder);
  void add(const Crown& crown);

  /// Sorts everything into the grid; call it once, after the last add.
  void build();

  /// Casts a ray; `ray` numbers it, so that leaves are hit or missed the same way every time.
  /// Returns false when nothing is met within max_range_m.
  bool cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m, std::uint64_t ray,
            Hit& hit) const;

  /// The same by trying everything: what cast is tested against.
  bool cast_brute_force(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                        std::uint64_t ray, Hit& hit) const;

  double ground(double x, double y) const { return ground_(x, y); }
  const std::vector<OrientedBox>& boxes() const { return boxes_; }
  const std::vector<Cylinder>& cylinders() const { return cylinders_; }
  const std::vector<Crown>& crowns() const { return crowns_; }
  const Eigen::Vector2d& extent_m() const { return extent_m_; }

 private:
  static constexpr double kCell_m = 4.0;
  enum class Kind : std::uint8_t { kBox, kCylinder, kCrown };
  struct Item {
    Kind kind;
    std::uint32_t index;
  };
  struct Turn {
    double cosine;
    double sine;
    double radius_sq;  // in the plan, of the circle around the box
  };
  struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;
    std::uint64_t number;
  };

  void insert(Kind kind, std::uint32_t index, double x, double y, double radius);
  void try_item(const Item& item, const Ray& ray, Hit& best) const;
  void try_box(const OrientedBox& box, const Turn& turn, const Ray& ray, Hit& best) const;
  void try_cylinder(const Cylinder& cylinder, const Ray& ray, Hit& best) const;
  void try_crown(const Crown& crown, std::uint32_t index, const Ray& ray, Hit& best) const;
  void try_ground(const Ray& ray, double from, double to, Hit& best) const;

  std::function<double(double, double)> ground_;
  Eigen::Vector2d extent_m_;
  Noise leaves_;
  double highest_m_ = 0.0;  // of anything
  std::vector<OrientedBox> boxes_;
  std::vector<Turn> turns_;  // of each box
  std::vector<Cylinder> cylinders_;
  std::vector<Crown> crowns_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<Item>> cells_;
  std::vector<double> cell_top_m_;  // highest ground in each cell
};

}  // namespace slamd::simulate
