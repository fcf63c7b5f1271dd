#include "tools/import/folder_import.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/packet.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/import/cloud_sequence.hpp"
#include "tools/import/recording_writer.hpp"

namespace slamd::importing {

namespace fs = std::filesystem;
using recording::RecordingError;

namespace {

constexpr std::size_t kMaxPoints = 1'048'576;

/// MulRan's xsens_imu.csv: timestamp, quaternion x y z w, Euler x y z, gyro x y z, acceleration x y
/// z, magnetic x y z.
constexpr std::size_t kMulranColumns = 17;
constexpr std::size_t kMulranGyro = 8;
constexpr std::size_t kMulranAcceleration = 11;

std::optional<sensor::ImuSample> parse_mulran_row(std::string_view line) {
  std::array<double, kMulranColumns> values{};
  sensor::ImuSample sample;
  for (std::size_t i = 0; i < kMulranColumns; ++i) {
    const std::size_t comma = std::min(line.find(','), line.size());
    const std::string_view word = line.substr(0, comma);
    line.remove_prefix(std::min(comma + 1, line.size()));
    const char* const end = word.data() + word.size();
    if (i == 0) {
      std::int64_t ns = 0;
      if (std::from_chars(word.data(), end, ns).ptr != end || word.empty()) {
        return std::nullopt;
      }
      sample.stamp = Stamp{Duration{ns}};
    } else if (std::from_chars(word.data(), end, values[i]).ptr != end || word.empty() ||
               !std::isfinite(values[i])) {
      return std::nullopt;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    sample.angular_rate_radps[i] = values[kMulranGyro + axis];
    sample.specific_force_mps2[i] = values[kMulranAcceleration + axis];
  }
  return sample;
}

/// Looks for the inertial samples of a MulRan sequence, in its folder or beside its clouds.
fs::path mulran_imu(const fs::path& folder) {
  for (const char* place : {"xsens_imu.csv", "sensor_data/xsens_imu.csv", "../xsens_imu.csv"}) {
    if (fs::exists(folder / place)) {
      return folder / place;
    }
  }
  return {};
}

void import_mulran_imu(const fs::path& file, const fs::path& directory, Summary& summary) {
  std::ifstream stream(file);
  ImuCsvWriter csv(directory / "imu.csv");
  std::string line;
  while (std::getline(stream, line)) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
      line.pop_back();
    }
    if (line.empty()) {
      continue;
    }
    if (const auto sample = parse_mulran_row(line)) {
      csv.write(*sample);
    } else {
      ++summary.refused["malformed_imu_row"];
    }
  }
  csv.close();
  summary.imu_samples = csv.rows();
}

bool has_kitti_rows(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::size_t words = 0;
  bool inside = false;
  for (const char c : line) {
    const bool blank = c == ' ' || c == '\t' || c == '\r' || c == ',';
    words += !blank && !inside ? 1 : 0;
    inside = !blank;
  }
  return words == 12;
}

void import_truth(const fs::path& file, const fs::path& directory, Summary& summary) {
  const auto poses = has_kitti_rows(file)
                         ? recording::read_kitti(file, directory / "lidar" / "times.txt")
                         : recording::read_tum(file);
  File out = create_file(directory / "truth.tum");
  for (const recording::StampedPose& pose : poses) {
    recording::write_tum_line(out.get(), pose.stamp, pose.T);
  }
  close_file(out, directory / "truth.tum");
  summary.truth_poses = poses.size();
}

void import_clouds(clouds::PointFolderReader& reader,
                   const fs::path& directory,
                   RecordingToml& toml,
                   const std::function<void(double share)>& progress,
                   Summary& summary) {
  CloudSequenceWriter writer(directory / "lidar");
  sensor::Scan scan(kMaxPoints);
  while (reader.next(scan)) {
    if (writer.scans() == 0) {
      toml.points_have_time = scan.points_have_time;
    }
    writer.write(
        scan.points.view(), toml.points_have_time, toml.points_have_time ? scan.begin : scan.end);
    progress(static_cast<double>(reader.files_read()) / static_cast<double>(reader.files()));
  }
  writer.close();
  const clouds::PointFolderCounters& counters = reader.counters();
  summary.scans = writer.scans();
  summary.points = counters.points;
  for (std::size_t i = 0; i < clouds::kCloudRefusals; ++i) {
    if (counters.refused[i] != 0) {
      summary.refused[std::string(name_of(static_cast<clouds::CloudRefusal>(i)))] =
          counters.refused[i];
    }
  }
  if (!counters.first_refused.empty()) {
    summary.remarks.push_back("first refused: " + counters.first_refused);
  }
  if (counters.over_capacity != 0) {
    summary.remarks.push_back(std::to_string(counters.over_capacity) + " points were over " +
                              std::to_string(kMaxPoints) + " a scan, and are left out");
  }
}

}  // namespace

Summary import_folder(const fs::path& folder,
                      const fs::path& directory,
                      const FolderOptions& options,
                      const std::function<void(double share)>& progress) {
  // MulRan keeps its clouds one level down.
  const fs::path source =
      fs::is_directory(folder / "sensor_data") ? folder / "sensor_data" : folder;
  clouds::PointFolderReader reader(source, options.reading);
  Summary summary;
  RecordingToml toml;
  toml.made_from = folder.filename().empty() ? folder.parent_path().filename().string()
                                             : folder.filename().string();
  toml.model = "points";
  toml.source = "lidar";
  import_clouds(reader, directory, toml, progress, summary);
  if (summary.scans == 0) {
    throw RecordingError(folder,
                         "no cloud could be read (" + reader.counters().first_refused + ")");
  }
  summary.remarks.push_back("stamps from " + std::string(name_of(reader.stamp_source())) +
                            (toml.points_have_time
                                 ? "; each point has its time"
                                 : "; the points have no time: compensated already"));
  if (const fs::path imu = mulran_imu(source); !imu.empty()) {
    import_mulran_imu(imu, directory, summary);
    toml.has_imu = summary.imu_samples > 0;
  }
  if (!options.truth.empty()) {
    import_truth(options.truth, directory, summary);
  }
  write_recording_toml(directory, toml);
  return summary;
}

}  // namespace slamd::importing
