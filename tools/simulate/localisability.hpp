#pragma once

#include <filesystem>

#include <Eigen/Core>

#include "tools/simulate/scene.hpp"

namespace slamd::simulate {

/// How well the true surfaces around the vehicle hold its position: from the world alone, whatever a filter makes of it.
///
/// Beams of one scan meet the true surfaces with their true normals. A beam says how far the sensor is along its
/// surface's normal; the sum over all beams, with the turns found from the same beams (Schur complement), is the
/// information on the position. The direction with the least of it is the weak one.
/// Frames: world.
struct TrueLocalisability {
  Eigen::Vector3d weakest = Eigen::Vector3d::UnitX();
  double share = 0.0;   // of the information, in the weakest direction: 1/3 where all are alike
  double second = 0.0;  // the same of the next
  int beams = 0;        // that met a surface
};

/// Looks at one scan that ends at t_s; the vehicle is taken to stand still during it.
TrueLocalisability true_localisability(const Scene& scene, double t_s);

/// Writes localisability.csv: ten moments a second.
void write_localisability(const Scene& scene, const std::filesystem::path& file);

}  // namespace slamd::simulate
