#pragma once

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "drivers/clouds/point_folder.hpp"

namespace slamd::storage {

/// The cloud of a file as the importers read it: x, y, z and nothing else. Errors: std::runtime_error.
inline std::vector<Eigen::Vector3d> read_back(const std::filesystem::path& file) {
  std::vector<std::byte> bytes;
  clouds::RawCloud cloud;
  if (clouds::read_cloud_file(file, bytes, cloud) || cloud.columns.size() != 3) {
    throw std::runtime_error(file.string() + ": is no cloud of x, y and z");
  }
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < cloud.points; ++i) {
    points.emplace_back(cloud.number(*cloud.find("x"), i), cloud.number(*cloud.find("y"), i), cloud.number(*cloud.find("z"), i));
  }
  return points;
}

}  // namespace slamd::storage
