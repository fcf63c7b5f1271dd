#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>

#include "core/loop/polar_image.hpp"
#include "tools/loopnet/scan_context.hpp"

namespace slamd::loopnet {

/// One row of visits.npy: who saw what from where. Distances and headings of two rows are compared only within one world.
struct VisitRow {
  float world = 0;   // a number
  float place = 0;   // within the world
  float kind = 0;    // of the world: index in place_world_names(); -1: a recording
  float sensor = 0;  // PlaceSensor::Kind; -1: a recording
  float indoor = 0;  // 1: places are a few metres apart
  float x_m = 0;
  float y_m = 0;
  float z_m = 0;
  float yaw_rad = 0;  // of level in world
};

/// Writes polar images and their visits as NumPy files: images.npy (uint8, N × 8 × 40 × 120), contexts.npy (float32,
/// N × 20 × 60: what Scan Context makes of the same points) and visits.npy (float32, N × 9).
/// Errors: std::runtime_error where a file cannot be written.
class PlaceFile {
 public:
  explicit PlaceFile(const std::filesystem::path& folder);

  void add(const VisitRow& row, const loop::PolarImage& image, const ScanContext& context);

  /// Writes the number of rows into the headers; call it once, last.
  void close();

  std::size_t rows() const { return rows_; }

 private:
  std::ofstream images_;
  std::ofstream contexts_;
  std::ofstream visits_;
  std::size_t rows_ = 0;
};

}  // namespace slamd::loopnet
