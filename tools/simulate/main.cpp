#include <cstdio>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/cli/cli.hpp"
#include "tools/simulate/simulate.hpp"

namespace {

namespace fs = std::filesystem;
using namespace slamd;

struct Options {
  simulate::Drive drive;
  std::string world = "town";
  std::string lidar = "vlp16";
  std::string out;
  bool force = false;
};

void declare(CLI::App& app, Options& options) {
  app.add_option("--out", options.out, "Directory of the recording to be made")->required();
  app.add_option("--world", options.world, "Where to drive")->check(CLI::IsMember({"town"}))->capture_default_str();
  app.add_option("--lidar", options.lidar, "Sensor")->check(CLI::IsMember({"vlp16", "livox_avia"}))->capture_default_str();
  app.add_option("--seed", options.drive.seed, "Of world, tour and noise")->capture_default_str();
  app.add_option("--duration", options.drive.duration_s, "Length of the drive, s")->check(CLI::Range(5.0, 3600.0))->capture_default_str();
  app.add_option("--speed", options.drive.speed_mps, "Pace, m/s")->check(CLI::Range(0.1, 10.0))->capture_default_str();
  app.add_option("--rest", options.drive.rest_s, "Standing still at the start, s")->check(CLI::Range(0.0, 60.0))->capture_default_str();
  app.add_option("--imu-rate", options.drive.imu_rate_hz, "Of the external inertial sensor, Hz")->check(CLI::Range(50.0, 1000.0))->capture_default_str();
  app.add_option("--threads", options.drive.threads, "Of the ray casting; any number gives the same bytes")->check(CLI::Range(1, 64))->capture_default_str();
  app.add_flag("--force", options.force, "Write into a directory that is not empty");
}

int run(Options& options) {
  options.drive.lidar = options.lidar == "vlp16" ? simulate::LidarKind::kVlp16 : simulate::LidarKind::kLivoxAvia;
  if (fs::exists(options.out) && (!fs::is_directory(options.out) || (!fs::is_empty(options.out) && !options.force))) {
    throw cli::UsageError(options.out + ": is not empty (--force writes into it all the same)");
  }
  fs::create_directories(options.out);
  simulate::Summary summary;
  {
    cli::Progress progress("simulating");
    summary = simulate::simulate(options.drive, options.out, [&](double share) { progress.show(share); });
  }
  std::printf("%s: %s in town %llu, %.0f s, %.0f m, %llu packets, %.1f million rays\n", options.out.c_str(), options.lidar.c_str(),
              static_cast<unsigned long long>(options.drive.seed), options.drive.duration_s, summary.path_m,
              static_cast<unsigned long long>(summary.packets), 1e-6 * static_cast<double>(summary.rays));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_program(argc, argv, "slamd-simulate", "Simulates a drive with exact truth as a recording of raw packets.",
                          [&](CLI::App& app) { declare(app, options); }, [&] { return run(options); });
}
