#include "tools/bench/ray_speed.hpp"

#include <cmath>

#include "tools/bench/thread_time.hpp"
#include "tools/simulate/scene.hpp"

namespace slamd::bench {

namespace {

/// Calls work(i), which returns how many rays it cast, until the time is over. Units: millions a second.
template <typename Work>
double speed_of(double seconds, Work&& work) {
  const double begin = thread_cpu_s();
  std::uint64_t rays = 0;
  double now = begin;
  for (std::uint64_t i = 0; now - begin < seconds; ++i) {
    rays += work(i);
    now = thread_cpu_s();
  }
  return 1e-6 * static_cast<double>(rays) / (now - begin);
}

}  // namespace

RaySpeed measure_ray_speed(const std::string& world, std::uint64_t seed, double seconds) {
  simulate::Drive drive;
  drive.world = world;
  drive.seed = seed;
  drive.duration_s = 120.0;
  const simulate::Scene scene(drive);
  const simulate::SpinningModel& model = simulate::model_of(simulate::SpinningKind::kVlp16);
  RaySpeed speed;
  speed.caster = speed_of(seconds, [&](std::uint64_t i) {
    const geometry::Se3 T = scene.motion().pose_at(std::fmod(0.37 * static_cast<double>(i), drive.duration_s)) *
                            scene.mounting().T_base_lidar;
    std::uint64_t rays = 0;
    for (int column = 0; column < 360; ++column) {
      const double alpha = column * M_PI / 180.0;
      for (std::size_t laser = 0; laser < 16; ++laser, ++rays) {
        const double omega = model.elevation_deg[laser] * M_PI / 180.0;
        const Eigen::Vector3d d(std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega));
        simulate::Hit hit;
        scene.world().cast(T.translation(), T.rotation() * d, 100.0, 6000 * i + rays, hit);
      }
    }
    return rays;
  });
  speed.packets = speed_of(seconds, [&](std::uint64_t i) {
    const simulate::SentPacket packet = scene.lidar().packet((i * 97) % scene.packets());
    return packet.payload.empty() ? 0 : scene.lidar().shots();
  });
  return speed;
}

}  // namespace slamd::bench
