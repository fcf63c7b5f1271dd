#include "daemon/pipeline/pipeline.hpp"

#include "core/map/cell_table.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/neighbour_fit.hpp"

namespace slamd::pipeline {

using configuration::Configuration;
using configuration::LidarModel;

namespace {

/// Threads look at least so often whether they are to end.
constexpr Duration kLongestSleep = std::chrono::milliseconds(50);
/// A second of 1 kHz.
constexpr std::size_t kImuRing = 1024;

/// A third of a second of packets: Avia 2,500/s, Mid-360 2,083/s, VLP-16 dual 1,508/s.
std::size_t blocks_of(const Configuration& configuration) {
  return is_livox(configuration.lidar.model) ? 1024 : 512;
}

bus::PublisherConfig publisher_config(const Configuration& configuration) {
  bus::PublisherConfig config;
  config.url = configuration.lcm.url;
  config.prefix = configuration.lcm.prefix;
  config.scan_points = static_cast<std::size_t>(configuration.lcm.scan_points);
  return config;
}

}  // namespace

Pipeline::Pipeline(const Configuration& configuration, const transport::HostClock& clock)
    : configuration_(configuration),
      odometry_config_(resolved_odometry(configuration)),
      rings_(odometry_config_, blocks_of(configuration), kImuRing),
      publisher_(publisher_config(configuration)),
      ordinary_publisher_(publisher_config(configuration)),
      receive_(configuration, clock, rings_),
      preprocess_(configuration, odometry_config_, clock, rings_),
      odometry_(odometry_config_, clock, rings_),
      publish_(odometry_config_, configuration.lidar.scan_period, clock, rings_, publisher_, configuration.mapping.use) {
  if (configuration.mapping.use) {
    mapping_ = std::make_unique<MappingLoop>(stages::mapper_config(configuration), session_keeping(configuration), clock, rings_, ordinary_publisher_);
  }
  if (configuration.occupancy.use) {
    occupancy_ = std::make_unique<OccupancyLoop>(stages::grid_config(configuration), clock, rings_, ordinary_publisher_);
    publish_.feed_occupancy(configuration.lidar.T_base_lidar.translation());
  }
  if (SerialLine* line = receive_.serial_line(); line != nullptr) {
    serial_ = std::make_unique<SerialLoop>(configuration, clock, *line);
  }
  if (configuration.gnss.is_serial()) {
    gnss_ = std::make_unique<GnssLoop>(configuration, clock);
  }
}

Pipeline::~Pipeline() { stop(); }

template <typename Loop>
std::unique_ptr<threads::RealTimeThread> Pipeline::thread(const char* name, threads::Scheduling scheduling, bool may_block, Loop& loop) {
  heartbeats_.push_back(std::make_unique<threads::Heartbeat>(name, may_block));
  return std::make_unique<threads::RealTimeThread>(name, scheduling, [this, &loop, &heartbeat = *heartbeats_.back()] {
    while (!stopping_.load(std::memory_order_relaxed)) {
      loop.run_once(kLongestSleep);
      heartbeat.rounds.add();
    }
  });
}

template <typename Loop>
void Pipeline::run(const char* name, int priority, Loop& loop) {
  threads_.push_back(thread(name, {configuration_.realtime.fifo, configuration_.realtime.priority + priority}, false, loop));
}

void Pipeline::start() {
  stopping_ = false;
  heartbeats_.clear();
  // LCM allocates its locks with a connection's first message: before the threads start.
  publisher_.publish(bus::MapToOdom{});
  ordinary_publisher_.publish(bus::MapToOdom{});
  // What is nearest to the sensors goes first: a packet that is not fetched is lost, a scan can wait.
  run("slamd-odometry", 0, odometry_);
  run("slamd-preproc", 1, preprocess_);
  run("slamd-publish", 2, publish_);
  run("slamd-receive", 3, receive_);
  if (mapping_) {
    mapping_thread_ = thread("slamd-mapping", {}, true, *mapping_);  // a search through the graph may take seconds
  }
  if (occupancy_) {
    occupancy_thread_ = thread("slamd-occupancy", {}, true, *occupancy_);
  }
  if (serial_) {
    serial_thread_ = thread("slamd-serial", {}, true, *serial_);
  }
  if (gnss_) {
    gnss_thread_ = thread("slamd-gnss", {}, true, *gnss_);
  }
}

void Pipeline::stop() {
  stopping_ = true;
  threads_.clear();
  mapping_thread_.reset();
  if (mapping_) {
    mapping_->finish();
  }
  occupancy_thread_.reset();
  serial_thread_.reset();
  gnss_thread_.reset();
}

bool Pipeline::schedule(const configuration::RealtimeConfiguration& realtime) {
  const auto scheduled = [&](const configuration::RealtimeConfiguration& wanted) {
    bool all = true;
    for (std::size_t i = 0; i < threads_.size(); ++i) {  // in the order of start(): each one higher than the last
      all = threads_[i]->schedule({wanted.fifo, wanted.priority + static_cast<int>(i)}) && all;
    }
    return all;
  };
  if (!scheduled(realtime)) {
    scheduled(configuration_.realtime);
    return false;
  }
  configuration_.realtime = realtime;
  return true;
}

stages::NamedCounts Pipeline::wheels() const {
  stages::NamedCounts counts = receive_.wheels();
  if (!counts.empty()) {
    counts.emplace_back("used", odometry_.counts().wheels_used);
    counts.emplace_back("slipped", odometry_.counts().wheels_slipped);
  }
  return counts;
}

bool Pipeline::is_fifo() const {
  bool all = !threads_.empty();
  for (const auto& thread : threads_) {
    all = all && thread->is_fifo();
  }
  return all;
}

namespace {

/// What mapping keeps, at its limits; of points and poses less is touched until then.
void add_mapping(const Configuration& configuration, std::vector<MemoryItem>& plan) {
  const mapping::MapperConfig mapper = stages::mapper_config(configuration);
  const graph::NormalEquationsCapacity equations =
      graph::PoseGraph::equations_capacity({mapper.keyframes, mapper.loops}, mapper.back_end.factor_entries);
  plan.push_back({"points of keyframes", mapper.keyframes * mapper.points_a_cloud, 3 * sizeof(std::int16_t)});
  plan.push_back({"keyframes", mapper.keyframes, sizeof(mapping::Keyframe) + sizeof(mapping::Submap) + 2 * sizeof(geometry::Matrix6d)});
  if (mapper.use_loop_net) {
    plan.push_back({"descriptors of keyframes", mapper.keyframes, sizeof(loop::Descriptor) + sizeof(loop::KeyframeNumber)});
  }
  plan.push_back({"poses of the graph", mapper.keyframes, sizeof(graph::Node) + 5 * sizeof(geometry::Se3) + sizeof(geometry::Matrix6d)});
  plan.push_back({"loops of the graph", mapper.loops, 2 * sizeof(graph::Loop)});
  plan.push_back({"entries of the graph's factor", equations.factor_entries, sizeof(double) + sizeof(int)});
  plan.push_back({"cells of a candidate's submap", mapper.verification.map.max_cells, sizeof(map::PointCell)});
  plan.push_back({"surfaces of it", mapper.verification.map.max_surface_cells * 7 / 6, sizeof(map::SurfaceCell)});
}

}  // namespace

std::vector<MemoryItem> memory_plan(const Configuration& configuration) {
  const odometry::OdometryConfig& odometry = configuration.odometry;
  const scan::PreprocessConfig& scan = odometry.preprocess;
  const std::size_t job_bytes = sizeof(ScanJob) + scan.max_planar * sizeof(scan::FeaturePoint) +
                                scan.max_edge * sizeof(scan::FeaturePoint) + scan.max_map_points * sizeof(Eigen::Vector3f) +
                                2048 * sizeof(sensor::ImuSample);
  // Per point of a scan: usable, shape, deskewed, candidate, order, place, range, roughness, break, two sampler slots.
  constexpr std::size_t kScratchPerPoint = 1 + 1 + sizeof(Eigen::Vector3f) + 4 + 4 + sizeof(Eigen::Vector3f) + 4 + 4 + 1 + 4 * 16;
  std::vector<MemoryItem> plan = {
      {"packet blocks", blocks_of(configuration), sizeof(sensor::PointBlock)},
      {"scan jobs", Rings::kJobs, job_bytes},
      {"inertial samples in rings", 2 * kImuRing, sizeof(ImuArrival)},
      {"wheel samples in rings", Rings::kWheelSamples, sizeof(sensor::WheelSample)},
      {"scans for mapping", Rings::kMapScans, sizeof(MapScan)},
      {"points for mapping", Rings::kMapPoints * scan.max_map_points, sizeof(Eigen::Vector3f)},
      {"points to be carved", Rings::kCarveScans * scan.max_map_points, sizeof(Eigen::Vector3f)},
      {"requests for the map", Rings::kMapRequests, sizeof(occupancy::MapRequest)},
      {"scan poses on their way", Rings::kScanPoses, sizeof(ScanPose)},
      {"map cells being copied", Rings::kMapCells, sizeof(map::PointCell)},
      {"inertial samples kept", 3 * 2 * sensor::ImuBufferConfig{}.capacity, sizeof(sensor::ImuSample)},
      {"scans being assembled or waiting", 3 * scan.max_points, sizeof(sensor::Point)},
      {"preprocess scratch", scan.max_points, kScratchPerPoint},
      {"neighbours of features", scan.max_planar + scan.max_edge, sizeof(registration::NeighbourFit)},
      {"map, fine cells", odometry.map.max_cells, sizeof(map::PointCell) + 32 + 2 * sizeof(std::uint32_t)},
      {"map, coarse cells", odometry.map.max_surface_cells + odometry.map.max_surface_cells / 6,
       sizeof(map::SurfaceCell) + 32 + 2 * sizeof(std::uint32_t)},
      {"thread stacks", 4U + (configuration.mapping.use ? 1U : 0U) + (configuration.occupancy.use ? 1U : 0U) + (configuration.imu.source == "serial" ? 1U : 0U) + (configuration.gnss.is_serial() ? 1U : 0U), threads::RealTimeThread::kStackBytes},
  };
  if (configuration.mapping.use) {
    add_mapping(configuration, plan);
  }
  if (configuration.occupancy.use) {
    const occupancy::GridConfig grid = stages::grid_config(configuration);
    const std::size_t blocks = occupancy::window_about(Eigen::Vector3d::Zero(), grid).blocks();
    plan.push_back({"blocks of occupied and free cells", blocks, occupancy::RollingGrid::kBlock_bytes});
    plan.push_back({"ends of a scan's rays", grid.max_points, sizeof(Eigen::Vector3f)});
  }
  return plan;
}

}  // namespace slamd::pipeline
