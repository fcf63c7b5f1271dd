#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/stamp.hpp"

namespace slamd::clouds {

/// Where the scans' stamps come from; the first that is there is taken.
enum class StampSource : std::uint8_t {
  kTimesFile,   // times.txt (seconds) or timestamps.txt (seconds or KITTI's dates), beside the
                // clouds or above
  kFileNames,   // 13, 16 or 19 digits: ms, µs, ns since 1970; or seconds with a fraction
  kPointTimes,  // the points' own times, when they count from 1970 or from a clock of their own
  kRate,        // a fixed rate
};

std::string_view name_of(StampSource source);

/// One cloud file of a folder.
struct CloudFile {
  std::filesystem::path path;
  std::optional<Stamp> stamp;
};

/// The cloud files of a folder in their order, with what is known about their stamps.
struct FileList {
  std::vector<CloudFile> files;
  bool stamps_are_known = false;
  StampSource source = StampSource::kRate;  // when they are known
};

/// Lists the *.bin, *.pcd or *.ply files (whichever kind is the most frequent) of a folder, or of
/// the first of its usual subfolders that has some: velodyne, velodyne_points/data, data, clouds,
/// Scans, Ouster. Numbers in names count as numbers: 2.pcd comes before 10.pcd. Errors:
/// RecordingError for no folder, no clouds, or a times file with a line that is no time.
FileList list_clouds(const std::filesystem::path& folder);

}  // namespace slamd::clouds
