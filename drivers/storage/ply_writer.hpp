#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <Eigen/Core>

namespace slamd::storage {

/// Writes a point cloud as binary little-endian PLY (x, y, z as float), point by point; the header's count is filled
/// in at the end. Errors: std::runtime_error with the file and the cause.
class PlyWriter {
 public:
  explicit PlyWriter(const std::filesystem::path& file);

  /// Appends a point.  Units: m.
  void write(const Eigen::Vector3f& p);

  /// Fills in the count. Errors: the first thing that went wrong since the file was opened.
  void close();

  std::uint64_t points() const { return points_; }

 private:
  void write_header();
  void note(bool good);

  std::filesystem::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
  std::uint64_t points_ = 0;
  int error_ = 0;  // errno of the first failure
};

}  // namespace slamd::storage
