#pragma once

#include <random>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/sensor/scan.hpp"

namespace slamd::world {

/// A world that tests can compute with: a rectangular hall with pillars and two inner walls, seen by a 16-line sensor.
/// Frames: odom, z up, floor at z = 0.  Units: m.
class Room {
 public:
  /// Returns the distance to the first surface along a ray. `direction` has length 1.
  double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Returns points on all surfaces as seen from a pose, in the sensor's axes: 16 lines × `columns`, noise as given.
  std::vector<Eigen::Vector3f> points_lidar(const geometry::Se3& T_odom_lidar, int columns, double noise_m,
                                            std::mt19937_64& engine) const;

  /// Returns a scan whose points are all seen at their own time from a moving sensor: pose_at(seconds since begin).
  template <typename PoseAt>
  sensor::Scan scan(Stamp begin, Duration length, int columns, double noise_m, std::mt19937_64& engine,
                    PoseAt&& T_odom_lidar_at) const {
    sensor::Scan scan(static_cast<std::size_t>(16 * columns));
    scan.begin = begin;
    scan.end = begin + length;
    std::normal_distribution<double> noise(0.0, noise_m);
    for (int column = 0; column < columns; ++column) {
      for (int line = 0; line < 16; ++line) {
        const Duration offset = length * (16 * column + line) / (16 * columns);
        const geometry::Se3 T_odom_lidar = T_odom_lidar_at(to_seconds(offset));
        const Eigen::Vector3d d = direction(column, columns, line);
        const double range = cast(T_odom_lidar.translation(), T_odom_lidar.rotation() * d) + noise(engine);
        sensor::Point point;
        point.x_m = static_cast<float>(range * d.x());
        point.y_m = static_cast<float>(range * d.y());
        point.z_m = static_cast<float>(range * d.z());
        point.offset_ns = static_cast<std::uint32_t>(offset.count());
        point.line = static_cast<std::uint8_t>(line);
        scan.points.push_back(point);
      }
    }
    return scan;
  }

 private:
  static Eigen::Vector3d direction(int column, int columns, int line);
};

}  // namespace slamd::world
