#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/sensor/scan.hpp"
#include "drivers/clouds/conversion.hpp"
#include "drivers/clouds/file_list.hpp"

namespace slamd::clouds {

struct PointFolderOptions {
  double scans_per_second =
      10.0;  // where nothing tells stamps; also the longest period of a compensated scan
  bool points_have_time = true;  // false: compensated already, time fields are ignored
};

struct PointFolderCounters {
  std::uint64_t scans = 0;
  std::array<std::uint64_t, kCloudRefusals> refused{};  // files, by reason
  std::string first_refused;                            // "name: reason"
  std::uint64_t points = 0;                             // given out
  std::uint64_t empty = 0;                              // without a return
  std::uint64_t over_capacity = 0;                      // beyond the scan's

  std::uint64_t refused_for(CloudRefusal reason) const {
    return refused[static_cast<std::size_t>(reason)];
  }
};

/// Reads one cloud file into memory and takes it apart, by its extension. `bytes` backs the result.
/// Errors: kUnreadable, and those of the parsers.
std::optional<CloudRefusal> read_cloud_file(const std::filesystem::path& path,
                                            std::vector<std::byte>& bytes,
                                            RawCloud& cloud);

/// Reads a folder of clouds as scans: KITTI or MulRan .bin, PCD, PLY.
///
/// With per-point time a scan begins at its earliest point: at the point's own time where that
/// counts from 1970, else at the stamp plus the point's offset (offsets may be negative: stamps at
/// the end of a scan); it ends with its last point. Without, the points are taken for compensated:
/// the stamp is the scan's end, where its pose belongs, and the scan begins a period before. Stamps
/// come from the first of StampSource that is there. Errors: RecordingError from the constructor; a
/// file that cannot be used is counted by reason and passed over.
class PointFolderReader {
 public:
  PointFolderReader(const std::filesystem::path& folder, const PointFolderOptions& options);

  /// Reads the next scan that can be used; false after the last file. Points beyond the scan's
  /// capacity are counted in points_dropped. Indices count from 0 without gaps; ends increase.
  bool next(sensor::Scan& scan);

  const PointFolderCounters& counters() const { return counters_; }

  std::size_t files() const { return list_.files.size(); }

  std::size_t files_read() const { return next_file_; }

  /// Where the last scan's stamp and lines came from.
  StampSource stamp_source() const { return stamp_source_; }

  LineSource line_source() const { return cloud_.lines; }

 private:
  std::optional<CloudRefusal> read(std::size_t file, sensor::Scan& scan);
  std::optional<CloudRefusal> set_period(std::size_t file, sensor::Scan& scan);
  void copy_points(sensor::Scan& scan);

  PointFolderOptions options_;
  FileList list_;
  CloudConverter converter_;
  std::size_t next_file_ = 0;
  StampSource stamp_source_ = StampSource::kRate;
  std::optional<Stamp> last_end_;
  PointFolderCounters counters_;

  // scratch
  std::vector<std::byte> bytes_;
  RawCloud raw_;
  Cloud cloud_;
};

}  // namespace slamd::clouds
