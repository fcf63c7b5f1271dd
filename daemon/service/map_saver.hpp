#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/bus/messages.hpp"
#include "daemon/pipeline/pipeline.hpp"
#include "drivers/recording/tum.hpp"
#include "drivers/storage/ply_writer.hpp"

namespace slamd::service {

/// Answers the command "save": writes the map and the trajectory since odom began, both in map, to DIRECTORY/NAME/map.ply and
/// trajectory.tum; the folder gets its name when they are whole. With mapping the map is the clouds of all keyframes, and both
/// are as the loops have corrected them: the mapping thread writes it. Without, it is what the odometry's local map holds, which copies
/// it in parts between scans.
/// Threads: housekeeping.
class MapSaver {
 public:
  /// More poses than this: every second one is dropped. A scan of 10 Hz: 14 hours.
  static constexpr std::size_t kMostPoses = 500'000;

  MapSaver(std::filesystem::path directory, pipeline::Pipeline& pipeline) : directory_(std::move(directory)), pipeline_(pipeline) {}

  /// From the next save on.
  void set_directory(std::filesystem::path directory) { directory_ = std::move(directory); }

  bool is_busy() const { return job_ != nullptr; }

  /// Begins to save as `name`. Returns what is against it, in words; empty: nothing, and run_once() will tell the end.
  /// T_map_corrected: where a command has put the map that mapping corrects.
  std::string begin(std::uint64_t command_id, const std::string& name, const geometry::Se3& T_map_corrected);

  /// Goes on; returns the reply when it is done.
  std::optional<bus::Reply> run_once();

 private:
  struct Job {
    std::uint64_t command_id = 0;
    std::filesystem::path part;  // under this name until it is whole
    std::filesystem::path whole;
    geometry::Se3 T_map_corrected;
    std::unique_ptr<storage::PlyWriter> map;  // of the odometry; nullptr: mapping writes it
    std::uint64_t points = 0;
    mapping::CorrectedPath path;  // of the odom in the map that mapping corrects; without mapping they are one
    std::string fault;
  };

  void take_scan_poses();
  void add(const pipeline::ScanPose& pose);
  bool take_corrected_map();
  bool take_local_map();
  bus::Reply finish(Job& job);

  std::filesystem::path directory_;
  pipeline::Pipeline& pipeline_;
  std::uint32_t epoch_ = 0;
  std::vector<recording::StampedPose> trajectory_odom_;
  std::uint64_t every_ = 1;  // so many scans a pose
  std::uint64_t scans_ = 0;
  std::unique_ptr<Job> job_;
};

}  // namespace slamd::service
