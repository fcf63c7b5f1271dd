#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/loop/polar_image.hpp"
#include "tools/loopnet/place_sensor.hpp"
#include "tools/loopnet/place_world.hpp"
#include "tools/loopnet/scan_context.hpp"

namespace slamd::loopnet {

/// A visit to a place: where the keyframe truly is, and what Loop-Net is shown of it.
/// Frames: T_world_level, upright.
struct Visit {
  std::size_t place = 0;
  geometry::Se3 T_world_level;
  double heading_rad = 0.0;
  loop::PolarImage image;
  ScanContext context;
};

/// Which submaps a visitor makes.
enum class SubmapKind : std::uint8_t {
  kAny,     // of one scan or several (an Avia: always several), thinned or not
  kSingle,  // of one scan (an Avia: several), not thinned
  kMapped,  // as core/mapping keeps them: ten scans, the keyframe's and those right behind it, thinned to 4,096 points
};

struct VisitorSettings {
  PlaceSensor::Kind sensor = PlaceSensor::Kind::kVlp16;
  SubmapKind submaps = SubmapKind::kAny;
};

/// Drives a vehicle with one LiDAR to places of a world, again and again, as methods.md §5 says: each time a little beside,
/// there or back, with other cars and people about, with an imperfect attitude, and some echoes lost.
class Visitor {
 public:
  Visitor(const PlaceWorld& place_world, const VisitorSettings& settings, std::uint64_t seed);

  /// Returns `places` × `visits_each` visits, grouped by place; fewer where the world has no room for a place.
  std::vector<Visit> visit(std::size_t places, std::size_t visits_each);

 private:
  struct Line {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };

  double uniform(double low, double high) { return noise_.uniform(++draws_, low, high); }
  double normal() { return noise_.normal(1'000'000'000 + ++draws_); }
  double heading_for(double lane_rad);
  bool find(const Line& line, double along_m, Visit& visit);
  double clearance_m(const Eigen::Vector3d& origin, double heading_rad) const;
  /// How many scans a submap is made of, how far apart, of how many rays each, and how many of them lie behind the keyframe.
  struct Plan {
    std::size_t scans = 1;
    double step_m = 0.0;
    std::size_t rays = 0;
    double behind = 0.0;
  };

  Plan plan();
  void see(Visit& visit);
  void thin_submap();
  void scan(const geometry::Se3& T_world_base, std::size_t rays, double t_s);
  void thin(double cell_m);

  std::uint64_t draws_ = 0;  // the vehicle's own properties are drawn first
  const PlaceWorld& place_world_;
  VisitorSettings settings_;
  simulate::Noise noise_;
  PlaceSensor sensor_;
  double base_m_;   // above the floor
  double lidar_m_;  // above base
  double noise_m_;
  double drop_out_;
  std::vector<Line> lines_;
  std::uint64_t shots_ = 0;
  loop::PolarImager imager_;

  // scratch
  std::vector<Eigen::Vector3d> rays_;
  std::vector<Eigen::Vector3f> points_world_;
};

}  // namespace slamd::loopnet
