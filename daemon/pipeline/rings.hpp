#pragma once

#include <atomic>

#include "core/base/latest.hpp"
#include "core/base/pool.hpp"
#include "core/base/spsc_queue.hpp"
#include "core/geometry/se3.hpp"
#include "core/map/point_cell.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/point_block.hpp"
#include "core/sensor/wheel_sample.hpp"
#include "daemon/pipeline/map_placement.hpp"
#include "daemon/stages/mapping_stage.hpp"
#include "daemon/stages/occupancy_stage.hpp"
#include "daemon/stages/odometry_stage.hpp"
#include "daemon/stages/pose_stage.hpp"
#include "daemon/stages/preprocess_stage.hpp"
#include "daemon/threads/wake_up.hpp"

namespace slamd::pipeline {

/// An inertial sample with its arrival at the host.
struct ImuArrival {
  sensor::ImuSample sample;
  Stamp received{};
};

/// A scan on its way from preprocess through odometry to publish.
struct ScanJob {
  explicit ScanJob(const odometry::OdometryConfig& config) : scan(config) {}

  stages::PreprocessedScan scan;
  bool processed = false;  // false: the odometry was late and let it pass
  odometry::OdometryResult result;
  odometry::MotionStep motion;  // since the scan before
  stages::Anchor anchor;
};

/// Where a scan was, for the trajectory that is saved.
struct ScanPose {
  std::uint32_t epoch = 1;
  Stamp stamp{};
  geometry::Se3 T_odom_base;
};

using PointsPool = Pool<BoundedVector<Eigen::Vector3f>>;

/// A scan on its way to mapping.
struct MapScan {
  stages::ScanForMap scan;
  PointsPool::Handle points;  // in imu; empty: mapping was late, and has as many clouds to read as there are
};

/// A scan on its way to be carved.
struct CarveScan {
  stages::ScanToCarve scan;
  PointsPool::Handle points;  // in imu
};

using BlockPool = Pool<sensor::PointBlock>;
using JobPool = Pool<ScanJob>;

/// All that passes between the threads.
///
/// A ring of handles is as long as its pool and so never overflows: an empty pool drops the newest block or scan, which
/// its owner counts. The other rings are as long as a second of their data; when full, the newest is dropped, counted.
struct Rings {
  Rings(const odometry::OdometryConfig& config, std::size_t block_count, std::size_t imu_samples)
      : block_pool(block_count),
        job_pool(kJobs, config),
        points_pool(kMapPoints, config.preprocess.max_map_points),
        carve_pool(kCarveScans, config.preprocess.max_map_points),
        blocks(block_count),
        imu_to_preprocess(imu_samples),
        imu_to_publish(imu_samples),
        wheels_to_preprocess(kWheelSamples),
        to_odometry(kJobs),
        to_publish(kJobs),
        feedback(2 * kJobs),
        to_mapping(kMapScans),
        to_occupancy(kCarveScans),
        map_requests(kMapRequests),
        scan_poses(kScanPoses),
        map_cells(kMapCells) {}

  /// One in each of preprocess, odometry and publish, and one on its way.
  static constexpr std::size_t kJobs = 4;

  /// A second and more of 200 Hz.
  static constexpr std::size_t kWheelSamples = 256;
  /// Half a minute of scans.
  static constexpr std::size_t kScanPoses = 300;
  /// Half a minute of scans: so long mapping may think about one of them.
  static constexpr std::size_t kMapScans = 300;
  /// Of these, so many with their points.
  static constexpr std::size_t kMapPoints = 32;
  /// Scans that wait to be carved: more would be stale.
  static constexpr std::size_t kCarveScans = 3;
  /// Clients' requests between two scans.
  static constexpr std::size_t kMapRequests = 64;
  /// What the odometry copies of its map between two looks of housekeeping.
  static constexpr std::size_t kMapCells = 4096;

  // Pools come first: they must outlive the handles in the rings.
  BlockPool block_pool;  // acquired by receive, released by preprocess
  JobPool job_pool;      // acquired by preprocess, released by publish
  PointsPool points_pool;  // acquired by publish, released by mapping
  PointsPool carve_pool;   // acquired by publish, released by occupancy

  SpscQueue<BlockPool::Handle> blocks;           // receive    → preprocess
  SpscQueue<ImuArrival> imu_to_preprocess;       // receive    → preprocess
  SpscQueue<ImuArrival> imu_to_publish;          // receive    → publish
  SpscQueue<sensor::WheelSample> wheels_to_preprocess;  // receive → preprocess
  SpscQueue<JobPool::Handle> to_odometry;        // preprocess → odometry
  SpscQueue<JobPool::Handle> to_publish;         // odometry   → publish
  SpscQueue<stages::Feedback> feedback;          // odometry   → preprocess

  SpscQueue<MapScan> to_mapping;                 // publish    → mapping; full: dropped, counted

  SpscQueue<CarveScan> to_occupancy;             // publish    → occupancy
  SpscQueue<occupancy::MapRequest> map_requests; // housekeeping → occupancy; full: dropped, clients ask again

  Latest<stages::NewestSubmap> newest_submap;  // written by mapping, read by occupancy
  Latest<MapPlacement> placement;    // written by housekeeping, read by publish and mapping
  Latest<MapCorrection> correction;  // written by mapping, read by publish and housekeeping

  SpscQueue<ScanPose> scan_poses;                // publish    → housekeeping; full: dropped, the trajectory has a gap
  SpscQueue<map::PointCell> map_cells;           // odometry   → housekeeping; full: the copy goes on later

  std::atomic<std::uint32_t> epoch_wanted{1};  // written by housekeeping ("new-map"), read by all others
  std::atomic<std::uint32_t> map_wanted{0};    // written by housekeeping: copy number n of the map is wanted
  std::atomic<std::uint32_t> map_copied{0};    // written by the odometry: copy number n is whole, and in map_cells

  threads::WakeUp wake_preprocess;
  threads::WakeUp wake_odometry;
  threads::WakeUp wake_publish;
  threads::WakeUp wake_mapping;
  threads::WakeUp wake_occupancy;
};

}  // namespace slamd::pipeline
