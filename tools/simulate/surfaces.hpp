#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace slamd::simulate {

/// What a surface is made of, as far as a LiDAR can tell: share of the light that comes back.
using Reflectivity = float;

/// A box that stands upright, turned about the vertical.
struct OrientedBox {
  Eigen::Vector3d centre;
  Eigen::Vector3d half;
  double yaw_rad = 0.0;
  Reflectivity reflectivity = 0.4F;
  float transparency = 0.0F;  // share of the rays that pass as if it were not there: glass, nets
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

/// A face of a mesh, seen from both sides.
struct Triangle {
  std::array<Eigen::Vector3f, 3> corners;
  Reflectivity reflectivity = 0.4F;
};

/// A ray; its number decides which leaves and panes it meets, the same way every time.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  // of length 1
  std::uint64_t number = 0;
};

/// Where a ray ends.
struct Hit {
  double range_m = 0.0;
  double cos_incidence = 1.0;
  Reflectivity reflectivity = 0.0F;
};

/// Bounds of something, in world axes.
struct Bounds {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e30F);
  Eigen::Vector3f high = Eigen::Vector3f::Constant(-1e30F);

  void include(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

}  // namespace slamd::simulate
