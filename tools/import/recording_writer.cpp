#include "tools/import/recording_writer.hpp"

#include <cerrno>
#include <cstring>

#include "drivers/recording/packet.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::importing {

namespace fs = std::filesystem;
using recording::RecordingError;

File create_file(const fs::path& path) {
  File file(std::fopen(path.c_str(), "wb"), std::fclose);
  if (!file) {
    throw RecordingError(path, std::strerror(errno));
  }
  return file;
}

void close_file(File& file, const fs::path& path) {
  const bool failed = std::ferror(file.get()) != 0;
  if (std::fclose(file.release()) != 0 || failed) {
    throw RecordingError(path, "could not be written whole: " + std::string(std::strerror(errno)));
  }
}

void prepare_directory(const fs::path& directory, bool force) {
  if (fs::exists(directory) && !fs::is_directory(directory)) {
    throw cli::UsageError(directory.string() + ": is no directory");
  }
  if (fs::exists(directory) && !fs::is_empty(directory)) {
    if (!force) {
      throw cli::UsageError(directory.string() +
                            ": is not empty; --force overwrites the recording");
    }
    for (const char* name : {"recording.toml", "imu.csv", "truth.tum", "lidar.pcap", "lidar"}) {
      fs::remove_all(directory / name);
    }
  }
  fs::create_directories(directory);
}

ImuCsvWriter::ImuCsvWriter(const fs::path& path) : path_(path), file_(create_file(path)) {
  std::fputs("timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n", file_.get());
}

void ImuCsvWriter::write(const sensor::ImuSample& sample) {
  const Eigen::Vector3d& w = sample.angular_rate_radps;
  const Eigen::Vector3d& a = sample.specific_force_mps2;
  std::fprintf(file_.get(),
               "%lld,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
               static_cast<long long>(sample.stamp.time_since_epoch().count()),
               w.x(),
               w.y(),
               w.z(),
               a.x(),
               a.y(),
               a.z());
  ++rows_;
}

void ImuCsvWriter::close() {
  close_file(file_, path_);
}

void write_recording_toml(const fs::path& directory, const RecordingToml& toml) {
  const fs::path path = directory / "recording.toml";
  File file = create_file(path);
  const char* const place = "{ xyz_m = [0.0, 0.0, 0.0], rpy_deg = [0.0, 0.0, 0.0] }";
  std::fprintf(file.get(),
               "# Imported from %s.\n"
               "# Where the sensors sit on the vehicle is not in the source: fill in T_base_*.\n\n"
               "[[lidar]]\nmodel = \"%s\"\nsource = \"%s\"\nT_base_lidar = %s\n",
               toml.made_from.c_str(),
               toml.model.c_str(),
               toml.source.c_str(),
               place);
  if (toml.model == "points") {
    std::fprintf(file.get(), "points_have_time = %s\n", toml.points_have_time ? "true" : "false");
  }
  if (toml.has_imu) {
    std::fprintf(file.get(), "\n[imu]\nsource = \"imu.csv\"\nT_base_imu = %s\n", place);
  }
  close_file(file, path);
}

}  // namespace slamd::importing
