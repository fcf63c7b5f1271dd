#include "core/scan/preprocessor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamd::scan {

using geometry::Se3;
using sensor::Point;
using sensor::Scan;

namespace {

/// Tells whether a Livox tag marks the return as noise, or as a second or third echo.
/// Source: Livox SDK1 tag byte: bits 5-4 return number, 3-2 and 1-0 noise confidence.
bool is_noise_tag(std::uint8_t tag) {
  const int return_number = (tag >> 4) & 3;
  const int intensity_noise = (tag >> 2) & 3;
  const int spatial_noise = tag & 3;
  return return_number > 1 || intensity_noise == 1 || spatial_noise == 1 || spatial_noise == 2;
}

/// Median by half-metre bins: what tells indoor from outdoor needs no more.
class RangeMedian {
 public:
  void add(float range_m) {
    ++bins_[std::min(bins_.size() - 1, static_cast<std::size_t>(2.0F * range_m))];
    ++count_;
  }

  float median_m() const {
    std::uint32_t seen = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      seen += bins_[i];
      if (2 * seen >= count_) {
        return 0.5F * static_cast<float>(i) + 0.25F;
      }
    }
    return 0.0F;
  }

 private:
  std::array<std::uint32_t, 256> bins_{};
  std::uint32_t count_ = 0;
};

}  // namespace

DeskewedScan::DeskewedScan(const PreprocessConfig& config)
    : planar(config.max_planar), edge(config.max_edge), map_points_imu(config.max_map_points) {}

Preprocessor::Preprocessor(const PreprocessConfig& config)
    : config_(config),
      classifier_(config.features, config.max_points),
      sampler_(config.max_points),
      usable_(config.max_points),
      shapes_(config.max_points),
      deskewed_(config.max_points),
      candidates_(config.max_points) {}

void Preprocessor::process(const Scan& scan,
                           const ScanMotion& motion,
                           const Se3& T_imu_lidar,
                           const Se3& T_base_imu,
                           bool indoor,
                           DeskewedScan& out) {
  out.index = scan.index;
  out.begin = scan.begin;
  out.end = scan.end;
  const std::size_t count = std::min(scan.points.size(), config_.max_points);
  const std::span<const Point> points = scan.points.view().first(count);
  usable_.resize(count);
  shapes_.resize(count);
  deskewed_.resize(count);
  deskew(scan, motion, T_imu_lidar, T_base_imu, out);
  classifier_.classify(points, usable_.view(), shapes_.view());
  select_planar(points, indoor ? config_.feature_spacing_indoor_m : config_.feature_spacing_outdoor_m, out);
  select_edges(points, out);
  select_map_points(indoor ? config_.map_spacing_indoor_m : config_.map_spacing_outdoor_m, out);
}

void Preprocessor::deskew(const Scan& scan,
                          const ScanMotion& motion,
                          const Se3& T_imu_lidar,
                          const Se3& T_base_imu,
                          DeskewedScan& out) {
  const Eigen::Matrix3f R_imu_lidar = T_imu_lidar.rotation().cast<float>();
  const Eigen::Vector3f t_imu_lidar = T_imu_lidar.translation().cast<float>();
  const Eigen::Matrix3f R_base_imu = T_base_imu.rotation().cast<float>();
  const Eigen::Vector3f t_base_imu = T_base_imu.translation().cast<float>();
  RangeMedian ranges;
  out.points = 0;
  out.filtered = 0;
  for (std::size_t i = 0; i < deskewed_.size(); ++i) {
    const Point& point = scan.points[i];
    const Eigen::Vector3f p_imu = R_imu_lidar * Eigen::Vector3f(point.x_m, point.y_m, point.z_m) + t_imu_lidar;
    const float range_m = range_of(point);
    const bool usable = !is_noise_tag(point.tag) &&
                        config_.self_filter.keeps(R_base_imu * p_imu + t_base_imu, range_m);
    usable_[i] = usable ? 1 : 0;
    if (!usable) {
      ++out.filtered;
      continue;
    }
    ++out.points;
    ranges.add(range_m);
    deskewed_[i] = scan.points_have_time ? motion.to_end(p_imu, point.offset_ns) : p_imu;
  }
  out.median_range_m = ranges.median_m();
}

void Preprocessor::select_planar(std::span<const Point> points, float spacing_m, DeskewedScan& out) {
  const auto collect = [&](bool planar_only) {
    sampler_.reset(spacing_m, points.size());
    candidates_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool wanted = usable_[i] != 0 && (!planar_only || shapes_[i] == Shape::kPlanar);
      if (wanted && sampler_.admit(deskewed_[i])) {
        candidates_.push_back(static_cast<std::uint32_t>(i));
      }
    }
  };
  collect(true);
  out.raw_features = candidates_.size() < config_.few_features;
  if (out.raw_features) {
    collect(false);
  }
  out.planar.clear();
  // Evenly over the scan's time, and so over all directions, when there are more than are wanted.
  const std::size_t wanted = std::min(candidates_.size(), out.planar.capacity());
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::uint32_t i = candidates_[k * candidates_.size() / wanted];
    out.planar.push_back({deskewed_[i], range_of(points[i])});
  }
}

void Preprocessor::select_edges(std::span<const Point> points, DeskewedScan& out) {
  candidates_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (shapes_[i] == Shape::kEdge) {
      candidates_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  out.edge.clear();
  const std::size_t wanted = std::min(candidates_.size(), out.edge.capacity());
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::uint32_t i = candidates_[k * candidates_.size() / wanted];
    out.edge.push_back({deskewed_[i], range_of(points[i])});
  }
}

void Preprocessor::select_map_points(float spacing_m, DeskewedScan& out) {
  sampler_.reset(spacing_m, deskewed_.size());
  candidates_.clear();
  for (std::size_t i = 0; i < deskewed_.size(); ++i) {
    if (usable_[i] != 0 && sampler_.admit(deskewed_[i])) {
      candidates_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  out.map_points_imu.clear();
  const std::size_t wanted = std::min(candidates_.size(), out.map_points_imu.capacity());
  for (std::size_t k = 0; k < wanted; ++k) {
    out.map_points_imu.push_back(deskewed_[candidates_[k * candidates_.size() / wanted]]);
  }
}

}  // namespace slamd::scan
