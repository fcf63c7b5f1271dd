#pragma once

#include <filesystem>
#include <functional>

#include "drivers/clouds/point_folder.hpp"
#include "tools/import/summary.hpp"

namespace slamd::importing {

struct FolderOptions {
  clouds::PointFolderOptions reading;
  std::filesystem::path truth;  // TUM, or KITTI rows with one pose a scan; empty: none
};

/// Turns a folder of clouds (KITTI, MulRan, PCD, PLY) into a recording; of a MulRan folder also
/// xsens_imu.csv. Errors: RecordingError.
Summary import_folder(const std::filesystem::path& folder,
                      const std::filesystem::path& directory,
                      const FolderOptions& options,
                      const std::function<void(double share)>& progress);

}  // namespace slamd::importing
