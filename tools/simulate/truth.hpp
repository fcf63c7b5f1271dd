#pragma once

#include <filesystem>
#include <vector>

#include "tools/simulate/scene.hpp"

namespace slamd::simulate {

/// Two moments at which the vehicle was at the same place.
struct TrueLoop {
  double earlier_s = 0.0;
  double later_s = 0.0;
  double distance_m = 0.0;
  double yaw_rad = 0.0;  // of the later heading over the earlier one
};

/// Returns the revisits of a drive: pairs of key moments, 2 m of way apart, that are within 4 m of each other and more
/// than 25 m of way apart.
std::vector<TrueLoop> true_loops(const Motion& motion);

/// Writes truth.tum: base in world, 100 Hz.
void write_truth(const Motion& motion, const std::filesystem::path& file);

/// Writes loops.csv.
void write_loops(const std::vector<TrueLoop>& loops, const std::filesystem::path& file);

/// Returns points of the surfaces that can be seen from the path, one in each cube of `spacing_m`, free of noise and of
/// what moves.  Frames: world.
std::vector<Eigen::Vector3f> true_map(const Scene& scene, double spacing_m);

}  // namespace slamd::simulate
