#pragma once

#include <filesystem>
#include <span>

#include <Eigen/Core>

namespace slamd::storage {

/// Writes a point cloud as binary PCD 0.7 (x, y, z as float).  Units: m. Errors: std::runtime_error with the file and the cause.
void write_pcd(const std::filesystem::path& file, std::span<const Eigen::Vector3f> points);

}  // namespace slamd::storage
