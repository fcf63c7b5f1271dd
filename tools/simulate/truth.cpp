#include "tools/simulate/truth.hpp"

#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/scan/voxel_sampler.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/simulate/text_file.hpp"

namespace slamd::simulate {

namespace {

constexpr double kKeyDistance_m = 2.0;
constexpr double kNear_m = 4.0;
constexpr double kApart_m = 25.0;
constexpr std::size_t kMaxMapPoints = 4'000'000;

struct KeyMoment {
  double t_s;
  double way_m;
  Eigen::Vector3d p;
  double yaw_rad;
};

std::vector<KeyMoment> key_moments(const Motion& motion, double distance_m) {
  std::vector<KeyMoment> moments;
  double way = 0.0;
  Eigen::Vector3d last = motion.pose_at(0.0).translation();
  for (double t = 0.0; t <= motion.duration_s(); t += 0.1) {
    const geometry::Se3 T = motion.pose_at(t);
    way += (T.translation() - last).norm();
    last = T.translation();
    if (moments.empty() || way - moments.back().way_m >= distance_m) {
      moments.push_back({t, way, last, geometry::rpy_from_rotation(T.rotation()).z()});
    }
  }
  return moments;
}

}  // namespace

std::vector<TrueLoop> true_loops(const Motion& motion) {
  const std::vector<KeyMoment> moments = key_moments(motion, kKeyDistance_m);
  std::vector<TrueLoop> loops;
  for (std::size_t later = 0; later < moments.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const double distance = (moments[later].p - moments[earlier].p).norm();
      if (distance <= kNear_m && moments[later].way_m - moments[earlier].way_m > kApart_m) {
        loops.push_back({moments[earlier].t_s, moments[later].t_s, distance,
                         std::remainder(moments[later].yaw_rad - moments[earlier].yaw_rad, 2.0 * M_PI)});
      }
    }
  }
  return loops;
}

void write_truth(const Motion& motion, const std::filesystem::path& file) {
  TextFile out(file);
  for (int i = 0; i <= static_cast<int>(motion.duration_s() * kTruth_hz); ++i) {
    const double t_s = i / kTruth_hz;
    recording::write_tum_line(out.stream(), stamp_at(t_s), motion.pose_at(t_s));
  }
  out.close();
}

void write_loops(const std::vector<TrueLoop>& loops, const std::filesystem::path& file) {
  TextFile out(file);
  std::fprintf(out.stream(), "timestamp_ns,earlier_timestamp_ns,distance_m,yaw_rad\n");
  for (const TrueLoop& loop : loops) {
    std::fprintf(out.stream(), "%lld,%lld,%.3f,%.5f\n",
                 static_cast<long long>(stamp_at(loop.later_s).time_since_epoch().count()),
                 static_cast<long long>(stamp_at(loop.earlier_s).time_since_epoch().count()), loop.distance_m,
                 loop.yaw_rad);
  }
  out.close();
}

std::vector<Eigen::Vector3f> true_map(const Scene& scene, double spacing_m) {
  scan::VoxelSampler sampler(kMaxMapPoints);
  sampler.reset(static_cast<float>(spacing_m), kMaxMapPoints);
  const double step_m = std::max(1.0, scene.path_m() / 600.0);
  const Noise noise(scene.drive().seed, 120);
  std::vector<Eigen::Vector3f> points;
  std::uint64_t ray = 0;
  for (const KeyMoment& moment : key_moments(scene.motion(), step_m)) {
    const Eigen::Vector3d eye = scene.motion().pose_at(moment.t_s) * scene.mounting().T_base_lidar.translation();
    for (int i = 0; i < 7200 && points.size() < kMaxMapPoints; ++i, ++ray) {
      const double azimuth = noise.uniform(2 * ray, 0.0, 2.0 * M_PI);
      const double elevation = noise.uniform(2 * ray + 1, -0.7, 0.9);
      const Eigen::Vector3d d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                              std::sin(elevation));
      Hit hit;
      if (scene.world().cast(eye, d, 80.0, ray, hit, World::kStandingOnly)) {
        const Eigen::Vector3f p = (eye + hit.range_m * d).cast<float>();
        if (sampler.admit(p)) {
          points.push_back(p);
        }
      }
    }
  }
  return points;
}

}  // namespace slamd::simulate
