#include <cstdio>
#include <filesystem>
#include <string>

#include "drivers/recording/packet.hpp"
#include "tools/cli/cli.hpp"
#include "tools/import/bag_import.hpp"
#include "tools/import/folder_import.hpp"

namespace slamd::importing {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path source;
  fs::path directory;
  bool force = false;
  bool compensated = false;
  double scans_per_second = 10.0;
  fs::path truth;
  std::string lidar_topic;
  std::string imu_topic;
};

void declare(const cli::Command& app, Arguments& arguments) {
  app.option(
         "SOURCE", arguments.source, "Folder of clouds (KITTI, MulRan, PCD, PLY), or a ROS 1 bag")
      .required();
  app.option("RECORDING_DIR", arguments.directory, "Where the recording goes").required();
  app.flag("--force", arguments.force, "Overwrite the recording that is there");
  app.flag("--compensated",
               arguments.compensated,
               "The clouds are deskewed already: ignore point times");
  app.option(
         "--rate", arguments.scans_per_second, "Scans per second, for clouds without stamps")
      .within(0.5, 100.0)
      .shows_default();
  app.option("--truth",
                 arguments.truth,
                 "Reference poses: TUM, or KITTI rows, one a scan (folders only)")
      .existing_file();
  app.option("--lidar-topic", arguments.lidar_topic, "Bags: the LiDAR's topic");
  app.option("--imu-topic", arguments.imu_topic, "Bags: the inertial sensor's topic");
  app.footer(BagReader::available()
                 ? ""
                 : "This build cannot read ROS bags (librosbag-storage-dev was missing).");
}

void print(const Summary& summary, const fs::path& directory) {
  const auto count = [](std::uint64_t value, const char* what) {
    if (value != 0) {
      std::printf("  %-14s %llu\n", what, static_cast<unsigned long long>(value));
    }
  };
  std::printf("%s\n", directory.c_str());
  count(summary.scans, "scans");
  count(summary.packets, "packets");
  count(summary.points, "points");
  count(summary.imu_samples, "imu samples");
  count(summary.truth_poses, "truth poses");
  for (const auto& [reason, number] : summary.refused) {
    std::printf("  refused %s: %llu\n", reason.c_str(), static_cast<unsigned long long>(number));
  }
  for (const std::string& remark : summary.remarks) {
    std::printf("  %s\n", remark.c_str());
  }
  std::printf("  Fill in where the sensors sit: %s\n", (directory / "recording.toml").c_str());
}

int run(const Arguments& arguments) {
  if (!fs::exists(arguments.source)) {
    throw recording::RecordingError(arguments.source, "does not exist");
  }
  const bool is_bag = !fs::is_directory(arguments.source);
  if (is_bag && arguments.source.extension() != ".bag") {
    throw cli::UsageError(arguments.source.string() +
                          ": is neither a folder nor a ROS 1 bag (*.bag)");
  }
  if (is_bag && !BagReader::available()) {
    const BagReader says_what_is_missing(arguments.source);
  }
  prepare_directory(arguments.directory, arguments.force);
  cli::Progress bar("importing");
  const auto progress = [&bar](double share) {
    bar.show(share);
  };
  Summary summary;
  if (is_bag) {
    summary = import_bag(arguments.source,
                         arguments.directory,
                         {arguments.lidar_topic, arguments.imu_topic, !arguments.compensated},
                         progress);
  } else {
    FolderOptions options;
    options.reading.scans_per_second = arguments.scans_per_second;
    options.reading.points_have_time = !arguments.compensated;
    options.truth = arguments.truth;
    summary = import_folder(arguments.source, arguments.directory, options, progress);
  }
  print(summary, arguments.directory);
  return 0;
}

}  // namespace

}  // namespace slamd::importing

int main(int argc, char** argv) {
  slamd::importing::Arguments arguments;
  return slamd::cli::run_program(
      argc,
      argv,
      "slamd-import",
      "Turns foreign recordings into a recording directory for slamd-replay.",
      [&](const slamd::cli::Command& app) { slamd::importing::declare(app, arguments); },
      [&] { return slamd::importing::run(arguments); });
}
