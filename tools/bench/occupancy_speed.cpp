#include "tools/bench/occupancy_speed.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/occupancy/delta_source.hpp"
#include "core/scan/voxel_sampler.hpp"
#include "daemon/bus/map_encoding.hpp"
#include "daemon/bus/messages.hpp"
#include "tools/bench/thread_time.hpp"
#include "tools/simulate/scene.hpp"

namespace slamd::bench {

namespace {

constexpr int kShotsALine = 1800;
constexpr float kKeptSpacing_m = 0.25F;  // of what the odometry keeps of a scan outdoors

/// Returns a scan as preprocess would hand it on: one point in each cube.
std::vector<Eigen::Vector3f> kept_scan_at(const simulate::Scene& scene, const geometry::Se3& T_world_lidar, double t_s, scan::VoxelSampler& sampler) {
  const simulate::SpinningModel& model = simulate::model_of(simulate::SpinningKind::kVlp16);
  std::vector<Eigen::Vector3f> points_lidar;
  sampler.reset(kKeptSpacing_m, 16 * kShotsALine);
  std::uint64_t ray = static_cast<std::uint64_t>(1e3 * t_s) * 16 * kShotsALine;
  for (int column = 0; column < kShotsALine; ++column) {
    const double alpha = column * 2.0 * M_PI / kShotsALine;
    for (std::size_t laser = 0; laser < 16; ++laser) {
      const double omega = model.elevation_deg[laser] * M_PI / 180.0;
      const Eigen::Vector3d d(std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega));
      simulate::Hit hit;
      if (scene.world().cast(T_world_lidar.translation(), T_world_lidar.rotation() * d, 100.0, ray++, hit, t_s)) {
        const Eigen::Vector3f p_lidar = (hit.range_m * d).cast<float>();
        if (sampler.admit(p_lidar)) {
          points_lidar.push_back(p_lidar);
        }
      }
    }
  }
  return points_lidar;
}

double quantile_of(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace

OccupancySpeed measure_occupancy(const std::string& world, std::uint64_t seed, int scans, double cell_m) {
  simulate::Drive drive;
  drive.world = world;
  drive.seed = seed;
  drive.duration_s = 0.1 * scans + 10.0;
  const simulate::Scene scene(drive);
  occupancy::GridConfig config;
  config.cell_m = cell_m;
  config.max_points = 16 * kShotsALine;
  occupancy::RollingGrid grid(config);
  occupancy::DeltaSource source({}, grid);
  source.restart(1, 1);
  scan::VoxelSampler sampler(16 * kShotsALine);
  OccupancySpeed speed;
  speed.blocks = grid.states().size();
  std::vector<double> insert_ms;
  std::vector<double> tell_ms;
  std::vector<std::byte> buffer(bus::kLargestMessage_bytes);
  occupancy::MapDelta message;
  for (int i = 0; i < scans; ++i) {
    const double t_s = 5.0 + 0.1 * i;
    const geometry::Se3 T_world_base = scene.motion().pose_at(t_s);
    const geometry::Se3 T_world_lidar = T_world_base * scene.mounting().T_base_lidar;
    const std::vector<Eigen::Vector3f> points = kept_scan_at(scene, T_world_lidar, t_s, sampler);
    const std::uint64_t before = grid.changes().newest();
    const double begin = thread_cpu_s();
    grid.insert({points, T_world_lidar, T_world_base, T_world_lidar.translation()});
    const double inserted = thread_cpu_s();
    source.begin(Stamp{});
    std::vector<std::size_t> sizes;
    double told = 0.0;
    for (occupancy::DeltaKind kind{};;) {
      const double from = thread_cpu_s();
      const bool more = source.next(message, kind);
      told += thread_cpu_s() - from;
      if (!more) {
        break;
      }
      sizes.push_back(bus::encode(message, buffer));
    }
    speed.points += static_cast<double>(points.size()) / scans;
    if (i > 0) {  // the first tells the whole window
      insert_ms.push_back(1e3 * (inserted - begin));
      tell_ms.push_back(1e3 * told);
      speed.changed_blocks += static_cast<double>(grid.changes().newest() - before) / (scans - 1);
      for (const std::size_t size : sizes) {
        speed.bytes_per_s += 10.0 * static_cast<double>(size) / (scans - 1);
      }
    }
  }
  speed.insert_median_ms = quantile_of(insert_ms, 0.5);
  speed.insert_p99_ms = quantile_of(insert_ms, 0.99);
  speed.tell_median_ms = quantile_of(tell_ms, 0.5);
  return speed;
}

}  // namespace slamd::bench
