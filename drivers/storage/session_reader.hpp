#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "drivers/storage/session_records.hpp"

namespace slamd::storage {

/// A stretch of a segment that could not be read.
struct SessionDamage {
  std::string segment;  // the file's name
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::string what;  // "cut off", "checksum", ...
};

/// A session as it stands: what was retired is gone, of loops and poses the last word counts.
struct Session {
  SessionBegin begin;                     // of the first segment that is there
  std::vector<SessionKeyframe> keyframes;  // in the order of their ids
  std::vector<geometry::Se3> T_map_base;   // of each; where no correction came, T_odom_base
  std::vector<SessionLoop> loops;          // between keyframes that are there
  std::vector<SessionDamage> damage;
  std::uint64_t records = 0;
  std::uint64_t lost_records = 0;  // by their numbers: what damage or the quota has taken
  std::uint64_t bytes = 0;
  std::uint32_t segments = 0;
  bool closed = false;  // the writer ended in order
};

/// Reads a session whole, however it ended: what is damaged is named and left out, and reading goes on behind it.
/// `progress` is told the share that is read.
/// Errors: std::runtime_error where there is no session, or of a file that cannot be read.
Session read_session(const std::filesystem::path& folder, const std::function<void(double)>& progress = {});

}  // namespace slamd::storage
