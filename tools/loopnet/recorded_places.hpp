#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "tools/loopnet/place_file.hpp"

namespace slamd::loopnet {

/// A folder of clouds with the poses that somebody has found for them.
struct RecordedPlaces {
  std::filesystem::path clouds;  // *.bin, *.pcd or *.ply; the number in a file's name is the row of its pose
  std::filesystem::path poses;   // KITTI rows: T_world_lidar, world's z up, lidar's x ahead
  std::size_t submap = 1;        // clouds that a keyframe is shown with: its own and those before it
  double apart_m = 0.0;          // least distance of clouds that become keyframes; 0: all
  std::uint64_t seed = 1;        // each keyframe is turned by a random yaw
  bool turn = true;
  float world = 0.0F;            // number of the world; keyframes of two worlds are never the same place
  bool indoor = false;
  float sensor = -1.0F;          // 1: an Avia, whose headings count
};

/// Adds the keyframes of a folder to a file of places. Returns how many.
/// Errors: RecordingError for a folder without clouds, a cloud that cannot be read, a pose that is missing.
std::size_t add_recorded_places(const RecordedPlaces& places, PlaceFile& file);

}  // namespace slamd::loopnet
