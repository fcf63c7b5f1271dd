#pragma once

#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"
#include "core/scan/deskew.hpp"
#include "core/scan/features.hpp"
#include "core/scan/self_filter.hpp"
#include "core/scan/voxel_sampler.hpp"
#include "core/sensor/scan.hpp"

namespace slamd::scan {

/// How a scan becomes features.
struct PreprocessConfig {
  SelfFilter self_filter;
  FeatureConfig features;
  std::size_t max_points = 150'000;      // per scan; what a sensor sends beyond is counted
  std::size_t max_planar = 2'048;
  std::size_t max_edge = 512;
  std::size_t max_map_points = 12'000;
  std::size_t few_features = 100;        // fewer planar ones: uniform raw points instead
  float feature_spacing_outdoor_m = 0.3F;
  float feature_spacing_indoor_m = 0.25F;
  float map_spacing_outdoor_m = 0.25F;
  float map_spacing_indoor_m = 0.125F;
  Duration longest_scan = std::chrono::milliseconds(400);
};

/// A point of the deskewed scan. Frames: imu at the scan's end.  Units: m.
struct FeaturePoint {
  Eigen::Vector3f p_imu = Eigen::Vector3f::Zero();
  float range_m = 0.0F;  // from the lidar's origin at its own time
};

/// A deskewed scan, ready to be registered. All points as seen from the imu at `end`.
struct DeskewedScan {
  explicit DeskewedScan(const PreprocessConfig& config);

  std::uint64_t index = 0;
  Stamp begin{};
  Stamp end{};
  BoundedVector<FeaturePoint> planar;
  BoundedVector<FeaturePoint> edge;
  BoundedVector<Eigen::Vector3f> map_points_imu;  // what the map takes in once the pose is known
  std::uint32_t points = 0;                       // usable returns
  std::uint32_t filtered = 0;                     // own body, range, noise tags
  float median_range_m = 0.0F;
  bool raw_features = false;  // features were few: `planar` holds uniform raw points
};

/// Turns scans into deskewed features: the preprocess stage.
/// Real-time: allocates in the constructor only; O(points); preprocess thread only.
class Preprocessor {
 public:
  explicit Preprocessor(const PreprocessConfig& config);

  /// Deskews and extracts.
  /// `motion` covers the scan; T_imu_lidar and T_base_imu place the sensors; `indoor` chooses the spacing.
  void process(const sensor::Scan& scan,
               const ScanMotion& motion,
               const geometry::Se3& T_imu_lidar,
               const geometry::Se3& T_base_imu,
               bool indoor,
               DeskewedScan& out);

 private:
  void deskew(const sensor::Scan& scan,
              const ScanMotion& motion,
              const geometry::Se3& T_imu_lidar,
              const geometry::Se3& T_base_imu,
              DeskewedScan& out);
  void select_planar(std::span<const sensor::Point> points, float spacing_m, DeskewedScan& out);
  void select_edges(std::span<const sensor::Point> points, DeskewedScan& out);
  void select_map_points(float spacing_m, DeskewedScan& out);

  PreprocessConfig config_;
  FeatureClassifier classifier_;
  VoxelSampler sampler_;
  // scratch, sized once
  BoundedVector<std::uint8_t> usable_;       // per point of the scan
  BoundedVector<Shape> shapes_;              // per point of the scan
  BoundedVector<Eigen::Vector3f> deskewed_;  // per point of the scan, imu at the scan's end
  BoundedVector<std::uint32_t> candidates_;
};

}  // namespace slamd::scan
