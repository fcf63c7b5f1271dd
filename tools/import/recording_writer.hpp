#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "core/sensor/imu_sample.hpp"
#include "core/sensor/point.hpp"

namespace slamd::importing {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// Opens a file for writing. Errors: RecordingError.
File create_file(const std::filesystem::path& path);

/// Closes a file. Errors: RecordingError when not everything could be written.
void close_file(File& file, const std::filesystem::path& path);

/// Makes the directory of a new recording.
/// Errors: UsageError when it holds something already and `force` is not set; with `force`, what an
/// import writes (recording.toml, imu.csv, truth.tum, lidar.pcap, lidar/) is taken away first, and
/// other files stay.
void prepare_directory(const std::filesystem::path& directory, bool force);

/// Writes imu.csv (design.md, "Configuration, recordings").
class ImuCsvWriter {
 public:
  explicit ImuCsvWriter(const std::filesystem::path& path);

  void write(const sensor::ImuSample& sample);
  void close();

  std::uint64_t rows() const { return rows_; }

 private:
  std::filesystem::path path_;
  File file_;
  std::uint64_t rows_ = 0;
};

/// What an import has found out for recording.toml.
struct RecordingToml {
  std::string made_from;  // named in the first line
  std::string model;      // of [[lidar]]
  std::string source;     // of [[lidar]]
  bool points_have_time = true;
  bool has_imu = false;
};

/// Writes recording.toml: last of all, so that an import that was broken off leaves no recording.
/// Extrinsics are identity, and a comment says that they are to be filled in.
void write_recording_toml(const std::filesystem::path& directory, const RecordingToml& toml);

}  // namespace slamd::importing
