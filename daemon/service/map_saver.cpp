#include "daemon/service/map_saver.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace slamd::service {

namespace fs = std::filesystem;

std::string MapSaver::begin(std::uint64_t command_id, const std::string& name, const geometry::Se3& T_map_corrected) {
  if (directory_.empty()) {
    return "output.save_directory is not configured";
  }
  if (is_busy()) {
    return "another save is under way";
  }
  take_scan_poses();
  if (epoch_ != pipeline_.epoch()) {
    return "there is no map yet";
  }
  const fs::path whole = directory_ / name;
  const fs::path part = directory_ / ("." + name + ".part");
  try {
    if (fs::exists(whole)) {
      return whole.string() + " is there already";
    }
    fs::remove_all(part);
    fs::create_directories(part);
    job_ = std::make_unique<Job>(Job{command_id, part, whole, T_map_corrected, nullptr, 0, mapping::CorrectedPath({}), {}});
    if (pipeline_.mapping() != nullptr) {
      pipeline_.want_corrected_map({part / "map.ply", T_map_corrected, epoch_});
    } else {
      job_->map = std::make_unique<storage::PlyWriter>(part / "map.ply");
      pipeline_.want_map();
    }
  } catch (const std::exception& error) {
    job_.reset();
    std::error_code ignored;
    fs::remove_all(part, ignored);
    return error.what();
  }
  return {};
}

std::optional<bus::Reply> MapSaver::run_once() {
  take_scan_poses();
  if (!is_busy()) {
    return std::nullopt;
  }
  if (!(job_->map ? take_local_map() : take_corrected_map())) {
    return std::nullopt;
  }
  const std::unique_ptr<Job> job = std::move(job_);
  return finish(*job);
}

/// Returns whether the copy is whole.
bool MapSaver::take_local_map() {
  const Eigen::Matrix3f R = job_->T_map_corrected.rotation().cast<float>();
  const Eigen::Vector3f t = job_->T_map_corrected.translation().cast<float>();
  return pipeline_.take_map([&](const Eigen::Vector3f& p_odom) { job_->map->write(R * p_odom + t); });
}

/// Returns whether mapping has written it, or could not.
bool MapSaver::take_corrected_map() {
  auto map = pipeline_.take_corrected_map();
  if (!map) {
    return false;
  }
  take_scan_poses();  // of the scans that the map is of
  job_->points = map->points;
  job_->fault = map->epoch != epoch_ ? "the map has begun anew meanwhile" : map->fault;
  job_->path = mapping::CorrectedPath(std::move(map->path));
  return true;
}

bus::Reply MapSaver::finish(Job& job) {
  try {
    if (!job.fault.empty()) {
      throw std::runtime_error(job.fault);
    }
    if (job.map) {
      job.map->close();
      job.points = job.map->points();
    }
    std::FILE* stream = std::fopen((job.part / "trajectory.tum").c_str(), "wb");
    if (stream == nullptr) {
      throw std::runtime_error((job.part / "trajectory.tum").string() + ": " + std::strerror(errno));
    }
    for (const recording::StampedPose& pose : trajectory_odom_) {
      recording::write_tum_line(stream, pose.stamp, job.T_map_corrected * job.path.T_map_base(pose.stamp, pose.T));
    }
    if (std::fclose(stream) != 0) {
      throw std::runtime_error((job.part / "trajectory.tum").string() + ": " + std::strerror(errno));
    }
    fs::rename(job.part, job.whole);
  } catch (const std::exception& error) {
    std::error_code ignored;
    fs::remove_all(job.part, ignored);
    return bus::Reply{job.command_id, false, error.what()};
  }
  return bus::Reply{job.command_id, true,
                    job.whole.string() + ": " + std::to_string(job.points) + " points, " + std::to_string(trajectory_odom_.size()) + " poses"};
}

void MapSaver::take_scan_poses() {
  pipeline_.take_scan_poses([this](const pipeline::ScanPose& pose) { add(pose); });
}

void MapSaver::add(const pipeline::ScanPose& pose) {
  if (pose.epoch != epoch_) {
    epoch_ = pose.epoch;
    trajectory_odom_.clear();
    every_ = 1;
    scans_ = 0;
  }
  if (scans_++ % every_ != 0) {
    return;
  }
  if (trajectory_odom_.size() == kMostPoses) {
    for (std::size_t i = 0; i < kMostPoses / 2; ++i) {
      trajectory_odom_[i] = trajectory_odom_[2 * i];
    }
    trajectory_odom_.resize(kMostPoses / 2);
    every_ *= 2;
  }
  trajectory_odom_.push_back({pose.stamp, pose.T_odom_base});
}

}  // namespace slamd::service
