#pragma once

#include <cstddef>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/scan/voxel_sampler.hpp"

namespace slamd::mapping {

/// Gathers a keyframe's cloud from some scans, and thins it to a number of points that are evenly spread over space.
/// Real-time: memory sized once.
class CloudBuilder {
 public:
  /// At most `gathered` points are taken in; of what is more, the first are kept.
  explicit CloudBuilder(std::size_t gathered);

  /// Begins a cloud, one point in a cube of this side. Units: m.
  void begin(float spacing_m);

  /// Takes a scan's points in, by T_level_imu.
  void add(std::span<const Eigen::Vector3f> points_imu, const geometry::Se3& T_level_imu);

  /// Returns the cloud with at most `most` points: the cubes grow until it fits. Valid until the next call of any.
  std::span<const Eigen::Vector3f> thinned(std::size_t most);

  std::size_t size() const { return points_.size(); }

  /// Returns the median distance from the origin.  Units: m.
  double median_range_m();

 private:
  float spacing_m_ = 0.2F;
  scan::VoxelSampler gathering_;
  scan::VoxelSampler thinning_;
  BoundedVector<Eigen::Vector3f> points_;   // in level
  BoundedVector<Eigen::Vector3f> thinned_;
  BoundedVector<float> ranges_m_;
};

}  // namespace slamd::mapping
