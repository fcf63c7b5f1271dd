#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>

#include <Eigen/Core>

namespace slamd::storage {

/// Reads the points of a file that PlyWriter wrote, one after the other. Foreign files: drivers/clouds.
/// Errors: std::runtime_error with the file and the cause.
class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file);

  /// Returns the next point. Errors: where the file ends before.  Units: m.
  Eigen::Vector3f read();

 private:
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
};

}  // namespace slamd::storage
