#pragma once

#include <cstdint>
#include <span>

#include "core/occupancy/delta_source.hpp"
#include "core/occupancy/rolling_grid.hpp"
#include "core/odometry/odometry.hpp"
#include "daemon/configuration/configuration.hpp"

namespace slamd::stages {

/// Returns what the grid is built from.
occupancy::GridConfig grid_config(const configuration::Configuration& configuration);

/// What carving takes of a scan, and of which odom it is; passes between threads by copy, without its points.
struct ScanToCarve {
  Stamp stamp{};
  std::uint32_t epoch = 1;
  std::uint32_t map_restarts = 0;
  bool trusted = false;  // its pose is confirmed: others change nothing
  geometry::Se3 T_odom_base;
  geometry::Se3 T_odom_imu;
  Eigen::Vector3d origin_odom = Eigen::Vector3d::Zero();
};

/// Takes out of a scan's result what carving needs. The rays' origin is where the lidar was at the scan's middle.
ScanToCarve scan_to_carve(const odometry::OdometryResult& result, const scan::DeskewedScan& deskewed, std::uint32_t epoch,
                          const Eigen::Vector3d& p_base_lidar);

/// Where the newest submap is anchored, of which odom. Passes through Latest.
struct NewestSubmap {
  std::uint32_t epoch = 0;
  std::int32_t id = -1;
  double anchor_odom_m[3] = {0.0, 0.0, 0.0};

  static NewestSubmap of(std::uint32_t id, const Eigen::Vector3d& anchor_odom, std::uint32_t epoch) {
    return {epoch, static_cast<std::int32_t>(id), {anchor_odom.x(), anchor_odom.y(), anchor_odom.z()}};
  }
};

/// The occupancy stage: each scan carved into the grid around the robot, and the messages that tell it.
/// Real-time: allocates in the constructor only; one thread, not a real-time one.
class OccupancyStage {
 public:
  /// Maps are numbered by the time at which they begin, from `now` on.
  OccupancyStage(const occupancy::GridConfig& grid, const occupancy::DeltaConfig& delta, Stamp now);

  /// Takes a scan in. Another epoch, or an odometry that has begun its own map anew, begins another map.
  /// Frames: points in imu at the scan's end.
  void process(const ScanToCarve& scan, std::span<const Eigen::Vector3f> points_imu, const NewestSubmap& submap, Stamp now);

  /// Takes a client's request in.
  void request(const occupancy::MapRequest& request) { source_.request(request); }

  /// Calls send(MapDelta, DeltaKind) for each message that is due: after each scan, and some times a second without.
  template <typename Send>
  void tell(Send&& send) {
    source_.begin(stamp_);
    occupancy::DeltaKind kind{};
    while (source_.next(message_, kind)) {
      send(message_, kind);
    }
  }

  const occupancy::RollingGrid& grid() const { return grid_; }

 private:
  void restart(const ScanToCarve& scan, Stamp now);

  occupancy::RollingGrid grid_;
  occupancy::DeltaSource source_;
  std::int64_t map_id_ = 0;
  std::uint32_t epoch_ = 0;
  std::uint32_t map_restarts_ = 0;
  std::int32_t submap_ = -1;
  Stamp stamp_{};
  occupancy::MapDelta message_;
};

}  // namespace slamd::stages
