#include "drive.hpp"

#include <cmath>
#include <random>

#include "core/geometry/so3.hpp"

namespace slamd::report {

namespace {

constexpr int kScans = 600;
constexpr double kLong = 100.0;
constexpr double kWide = 60.0;

/// The place after a share of the way round, with some hills.
geometry::Se3 true_pose(double share) {
  const double round = 2.0 * (kLong + kWide);
  double s = share * round;
  const double sides[] = {kLong, kWide, kLong, kWide};
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  for (const double side : sides) {
    const double step = std::min(s, side);
    x += step * std::cos(yaw);
    y += step * std::sin(yaw);
    s -= step;
    if (s <= 0.0) {
      break;
    }
    yaw += 0.5 * M_PI;
  }
  return {geometry::rotation_from_rpy({0.0, 0.0, yaw}), {x, y, 0.5 * std::sin(2.0 * M_PI * share)}};
}

Stamp stamp_of(int i) {
  return Stamp{} + std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(100 * i);
}

FilterRun run_of(const std::string& filter, double drift, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 0.01);
  std::exponential_distribution<double> extra(0.5);
  FilterRun run{filter, {"decode", "preprocess", "odometry"}, {}};
  for (int i = 0; i < kScans; ++i) {
    const double share = static_cast<double>(i) / kScans;
    ScanSample scan;
    scan.pose.stamp = stamp_of(i);
    scan.pose.T = true_pose(share);
    scan.pose.T.translation() +=
        Eigen::Vector3d(drift * share + noise(random), drift * share * share, noise(random));
    scan.stage_ms = {0.8, 2.0 + 0.3 * extra(random), 6.0 + extra(random)};
    scan.particles = filter == "psf" ? 32 : 0;
    scan.state = "TRACKING";
    if (filter == "psf" && i >= 300 && i < 306) {
      scan.particles = i < 302 ? 256 : 64;
      scan.recovery_swarm = true;
      scan.swarm_won = i == 301;
      scan.stage_ms[2] += 25.0;
    }
    if (i >= 420 && i < 470) {
      scan.state = "DEGRADED";
      scan.cause = "a direction that the scan does not see";
    }
    run.scans.push_back(scan);
  }
  return run;
}

/// Ground and the fronts of houses on both sides of the way.
std::vector<Eigen::Vector3f> town(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 150'000; ++i) {
    const geometry::Se3 T = true_pose(unit(random));
    const double kind = unit(random);
    const double side = unit(random) < 0.5 ? -7.0 : 7.0;
    const Eigen::Vector3d p = kind < 0.5 ? Eigen::Vector3d(0.0, 14.0 * unit(random) - 7.0, -0.8)
                                         : Eigen::Vector3d(0.0, side, 9.0 * unit(random) - 0.8);
    points.push_back((T * p).cast<float>());
  }
  points.push_back({4000.0F, 0.0F, 50.0F});  // a stray
  return points;
}

}  // namespace

ReportContent drive_around_the_block() {
  std::mt19937 random(7);
  ReportContent content;
  content.recording = "recordings/around_the_block";
  content.made_with = "slamd-replay 0.1.0";
  content.run = run_of("psf", 0.04, random);
  content.comparison = run_of("iekf", 0.09, random);
  for (int i = 0; i <= 2 * kScans; ++i) {
    content.truth.push_back(
        {stamp_of(0) + std::chrono::milliseconds(50 * i), true_pose(0.5 * i / kScans)});
  }
  content.map_points = town(random);
  content.facts = {
      {"real-time factor", "11.8"}, {"scans dropped", "0"}, {"memory, largest", "212 MB"}};
  content.counters = {
      {"packets", {{"received", 452'812}, {"refused: short", 3}, {"refused: foreign", 17}}},
      {"inertial samples", {{"received", 12'004}, {"refused: out of order", 1}}}};
  content.remarks = {"The device clock ran 12 ppm fast."};
  content.configuration = "[[lidar]]\nmodel = \"vlp16\"\n\n[odometry]\nfilter = \"psf\"\n";
  return content;
}

}  // namespace slamd::report
