#include "tools/bench/neighbour_speed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/evaluation/median.hpp"
#include "core/map/point_grid.hpp"
#include "core/scan/voxel_sampler.hpp"
#include "tools/bench/neighbour_peers.hpp"
#include "tools/bench/thread_time.hpp"
#include "tools/simulate/noise.hpp"
#include "tools/simulate/scene.hpp"

namespace slamd::bench {

using evaluation::median_of;

namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr float kRadius_m = 1.0F;
constexpr double kScan_s = 0.1;
constexpr int kColumns = 1800;          // of a VLP-16 at 10 Hz
constexpr int kScansBetweenFills = 5;   // while the map fills
constexpr double kRangeNoise_m = 0.02;
constexpr std::size_t kBruteForceEvery = 10;  // queries

/// A drive of simulated scans, undistorted, at their true poses.
class Scans {
 public:
  explicit Scans(std::uint64_t seed) : scene_(drive_of(seed)), noise_(seed, 121), path_m_(scene_.path_m()) {}

  std::size_t count() const { return static_cast<std::size_t>(scene_.drive().duration_s / kScan_s); }

  double path_m(std::size_t scan) const {
    return path_m_ * static_cast<double>(scan) / static_cast<double>(count());
  }

  /// Returns a scan's points in firing order. Frames: world.
  Points points(std::size_t scan) const {
    const simulate::SpinningModel& model = simulate::model_of(simulate::SpinningKind::kVlp16);
    const double t_s = kScan_s * static_cast<double>(scan);
    const geometry::Se3 T = scene_.motion().pose_at(t_s) * scene_.mounting().T_base_lidar;
    Points points;
    std::uint64_t ray = scan * kColumns * 16;
    for (int column = 0; column < kColumns; ++column) {
      const double alpha = 2.0 * M_PI * column / kColumns;
      for (std::size_t laser = 0; laser < 16; ++laser, ++ray) {
        const double omega = model.elevation_deg[laser] * M_PI / 180.0;
        const Eigen::Vector3d d(std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega));
        simulate::Hit hit;
        if (scene_.world().cast(T.translation(), T.rotation() * d, 100.0, ray, hit)) {
          const double range_m = hit.range_m + kRangeNoise_m * noise_.normal(ray);
          points.push_back((T * Eigen::Vector3d(range_m * d)).cast<float>());
        }
      }
    }
    return points;
  }

 private:
  static simulate::Drive drive_of(std::uint64_t seed) {
    simulate::Drive drive;
    drive.seed = seed;
    drive.duration_s = 300.0;
    return drive;
  }

  simulate::Scene scene_;
  simulate::Noise noise_;
  double path_m_;
};

Points sampled(const Points& points, float spacing_m) {
  scan::VoxelSampler sampler(points.size());
  sampler.reset(spacing_m, points.size());
  Points kept;
  for (const Eigen::Vector3f& p : points) {
    if (sampler.admit(p)) {
      kept.push_back(p);
    }
  }
  return kept;
}

Points counted_off(const Points& points, std::size_t wanted) {
  Points kept;
  wanted = std::min(wanted, points.size());
  for (std::size_t k = 0; k < wanted; ++k) {
    kept.push_back(points[k * points.size() / wanted]);
  }
  return kept;
}

Found brute_force(const Points& stored, const Eigen::Vector3f& query) {
  std::vector<float> within;
  for (const Eigen::Vector3f& p : stored) {
    const Eigen::Vector3f d = p - query;
    const float distance_sq = (d.x() * d.x() + d.y() * d.y()) + d.z() * d.z();
    if (distance_sq < kRadius_m * kRadius_m) {
      within.push_back(distance_sq);
    }
  }
  std::sort(within.begin(), within.end());
  Found found;
  found.count = std::min(within.size(), Found::kMax);
  std::copy_n(within.begin(), found.count, found.distance_sq_m2.begin());
  return found;
}

/// What one structure did, scan by scan.
struct Record {
  std::string name;
  std::vector<double> upkeep_s;
  std::vector<double> search_s;
  std::size_t expected = 0;  // neighbours, by brute force
  std::size_t matched = 0;

  void compare(const std::vector<Found>& truth, const std::vector<Found>& found) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const Found& answer = found[i * kBruteForceEvery];
      expected += truth[i].count;
      for (std::size_t k = 0; k < std::min(truth[i].count, answer.count); ++k) {
        // Libraries add the squares in other orders.
        matched += std::abs(answer.distance_sq_m2[k] - truth[i].distance_sq_m2[k]) < 1e-4F ? 1U : 0U;
      }
    }
  }
};

template <typename Work>
double time_of(Work&& work) {
  const double begin = thread_cpu_s();
  work();
  return thread_cpu_s() - begin;
}

NeighbourSpeed speed_of(const Record& record, std::size_t queries) {
  NeighbourSpeed speed;
  speed.name = record.name;
  std::vector<double> total_s;
  for (std::size_t i = 0; i < record.upkeep_s.size(); ++i) {
    total_s.push_back(record.upkeep_s[i] + record.search_s[i]);
  }
  speed.upkeep_ms = 1e3 * median_of(record.upkeep_s);
  speed.search_ms = 1e3 * median_of(record.search_s);
  speed.total_ms = 1e3 * median_of(total_s);
  speed.query_us = 1e6 * median_of(record.search_s) / static_cast<double>(queries);
  speed.recall = record.expected == 0 ? 0.0 : static_cast<double>(record.matched) / static_cast<double>(record.expected);
  return speed;
}

}  // namespace

std::vector<NeighbourCase> neighbour_cases() {
  return {{"LIO-SAM-like", 44'000, 5'800, 0.4F, 0.2F}, {"dense", 47'000, 20'000, 0.25F, 0.02F}};
}

NeighbourTable measure_neighbours(const NeighbourCase& sizes,
                                  std::uint64_t seed,
                                  int scans,
                                  const std::function<void(double)>& progress) {
  const Scans drive(seed);
  map::PointGrid grid(sizes.spacing_m * static_cast<float>(map::PointCell::kDivisions), 60'000);
  const auto stored_points = [&] {
    Points stored;
    grid.for_each_point([&](const Eigen::Vector3f& p) { stored.push_back(p); });
    return stored;
  };

  std::size_t now = 0;
  for (; stored_points().size() < sizes.stored_points && now < drive.count(); now += kScansBetweenFills) {
    grid.insert(sampled(drive.points(now), sizes.spacing_m), static_cast<float>(drive.path_m(now)));
  }
  // From here on as much is forgotten as is learned.
  const double window_m = drive.path_m(now);

  const auto peers = neighbour_peers();
  std::vector<Record> records(1 + peers.size());
  records[0].name = "slamd";
  std::vector<double> stored_counts;
  std::vector<double> inserted_counts;
  std::vector<Found> found(sizes.queries);
  for (int scan = 0; scan < scans; ++scan, ++now) {
    const Points fresh = sampled(drive.points(now), sizes.spacing_m);
    const Points queries = counted_off(sampled(drive.points(now + 1), sizes.query_spacing_m), sizes.queries);
    found.resize(queries.size());
    const auto path_m = static_cast<float>(drive.path_m(now));
    records[0].upkeep_s.push_back(time_of([&] {
      grid.forget_before(path_m - static_cast<float>(window_m));
      grid.insert(fresh, path_m);
    }));
    records[0].search_s.push_back(time_of([&] {
      for (std::size_t i = 0; i < queries.size(); ++i) {
        if (i + map::PointGrid::kAhead < queries.size()) {
          grid.prefetch(queries[i + map::PointGrid::kAhead]);
        }
        const map::Neighbours nearest = grid.nearest(queries[i], kRadius_m);
        found[i] = {nearest.count, nearest.distance_sq_m2};
      }
    }));
    const Points stored = stored_points();
    stored_counts.push_back(static_cast<double>(stored.size()));
    inserted_counts.push_back(static_cast<double>(fresh.size()));
    std::vector<Found> truth;
    for (std::size_t i = 0; i < queries.size(); i += kBruteForceEvery) {
      truth.push_back(brute_force(stored, queries[i]));
    }
    records[0].compare(truth, found);
    for (std::size_t peer = 0; peer < peers.size(); ++peer) {
      Record& record = records[1 + peer];
      record.name = peers[peer]->name();
      peers[peer]->take(stored);
      record.upkeep_s.push_back(time_of([&] { peers[peer]->build(); }));
      record.search_s.push_back(time_of([&] { peers[peer]->search(queries, kRadius_m, found); }));
      record.compare(truth, found);
    }
    progress(static_cast<double>(scan + 1) / scans);
  }

  NeighbourTable table;
  table.sizes = sizes;
  table.stored_points = static_cast<std::size_t>(median_of(stored_counts));
  table.inserted_points = static_cast<std::size_t>(median_of(inserted_counts));
  for (const Record& record : records) {
    table.structures.push_back(speed_of(record, found.size()));
  }
  return table;
}

std::string text_of(const NeighbourTable& table) {
  std::array<char, 256> line{};
  const NeighbourSpeed& reference = table.structures[table.structures.size() > 1 ? 1 : 0];
  std::snprintf(line.data(), line.size(), "%s: %zu points stored, %zu queries and %zu points a scan, k = 5 within 1 m\n",
                table.sizes.name.c_str(), table.stored_points, table.sizes.queries, table.inserted_points);
  std::string text = line.data();
  std::snprintf(line.data(), line.size(), "  %-16s %9s %9s %8s %8s %8s %9s %7s\n", "", "upkeep ms", "search ms", "scan ms",
                "faster", "query us", "faster", "recall");
  text += line.data();
  for (const NeighbourSpeed& speed : table.structures) {
    std::snprintf(line.data(), line.size(), "  %-16s %9.2f %9.2f %8.2f %7.2fx %8.3f %8.2fx %7.4f\n", speed.name.c_str(),
                  speed.upkeep_ms, speed.search_ms, speed.total_ms, reference.total_ms / speed.total_ms, speed.query_us,
                  reference.query_us / speed.query_us, speed.recall);
    text += line.data();
  }
  return text;
}

}  // namespace slamd::bench
