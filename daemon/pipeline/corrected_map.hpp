#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/mapping/corrections.hpp"

namespace slamd::pipeline {

/// The map as mapping has corrected it, written to a file.
struct CorrectedMap {
  std::uint64_t points = 0;
  std::uint32_t epoch = 0;  // of the odom that it is of
  std::vector<mapping::CorrectedKeyframe> path;  // in the map that mapping corrects
  std::string fault;        // why it could not be written; empty: it is
};

/// Lets housekeeping ask the mapping thread for the corrected map. Neither is a real-time thread: a mutex is held to hand over.
/// Threads: want() and take() by housekeeping, wanted() and give() by mapping.
class CorrectedMapRequest {
 public:
  struct Wanted {
    std::filesystem::path ply;
    geometry::Se3 T_map_corrected;  // where a command has put the map that mapping corrects
    std::uint32_t epoch = 1;        // of the odom that the map is to be of
  };

  void want(const Wanted& wanted) {
    const std::lock_guard lock(mutex_);
    wanted_ = wanted;
    given_.reset();
  }

  std::optional<CorrectedMap> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(given_, std::nullopt);
  }

  /// Returns what is wanted, once; not before mapping has come to that odom: it may have scans of the one before to take in.
  std::optional<Wanted> wanted(std::uint32_t epoch) {
    const std::lock_guard lock(mutex_);
    return wanted_ && wanted_->epoch <= epoch ? std::exchange(wanted_, std::nullopt) : std::nullopt;
  }

  void give(CorrectedMap map) {
    const std::lock_guard lock(mutex_);
    given_ = std::move(map);
  }

 private:
  std::mutex mutex_;
  std::optional<Wanted> wanted_;
  std::optional<CorrectedMap> given_;
};

}  // namespace slamd::pipeline
