#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "daemon/configuration/key_table.hpp"
#include "tools/cli/cli.hpp"
#include "tools/cli/interrupts.hpp"
#include "tools/replay/session.hpp"
#include "tools/replay/to_network.hpp"

namespace {

namespace fs = std::filesystem;
using namespace slamd;

struct Options {
  std::string recording;
  std::string out;
  std::vector<std::string> configs;
  std::vector<std::string> overrides;
  std::string compare;
  std::string to_network;
  std::string imu_to;
  std::string gnss_to;
  std::string can_to;
  double speed = 1.0;
  bool json = false;
  bool print_configuration = false;
};

void declare(const cli::Command& app, Options& options) {
  app.option("RECORDING", options.recording, "Directory with recording.toml, or a capture with --config").required();
  app.option("--out", options.out, "Directory for odometry.tum, trajectory.tum, map.ply, report.json, report.html");
  app.option("--config", options.configs, "TOML file; wins over recording.toml key by key");
  app.option("--set", options.overrides, "key=value; wins over all files").take_all();
  app.option("--compare", options.compare, "Run a second filter on the same recording, side by side").one_of({"psf", "iekf"});
  cli::Option to_network =
      app.option("--to-network", options.to_network, "HOST[:DATA_PORT[:POSITION_PORT]]: send the packets there with their timing instead of mapping them")
          .excludes({"--out", "--compare"});
  app.option("--speed", options.speed, "With --to-network: times real time; 0: as fast as it goes").needs(to_network);
  app.option("--imu-to", options.imu_to, "With --to-network: where the rows of imu.csv go: udp:HOST:PORT, pty:LINKPATH, or as an emulated sensor sends them, xsens:LINKPATH, mip:LINKPATH").needs(to_network);
  app.option("--gnss-to", options.gnss_to, "With --to-network: where the fixes of gnss.csv go, as an emulated receiver sends them: nmea:LINKPATH, ubx:LINKPATH, or both:LINKPATH").needs(to_network);
  app.option("--can-to", options.can_to, "With --to-network: the CAN interface to which the frames of the recording's candump logs go, such as vcan0").needs(to_network);
  app.flag("--json", options.json, "Print the report as JSON instead of the summary");
  app.flag("--print-config", options.print_configuration, "Print the complete configuration and exit");
  app.action(
      "--print-keys",
      [] {
        std::fputs(configuration::print_reference().c_str(), stdout);
        std::exit(0);
      },
      "Print a table of all keys and exit");
  app.footer("Exit code: 0 the recording was processed to its end; 1 it could not be, or was interrupted; 2 bad configuration or usage.\n"
             "All keys: docs/configuration.md.");
}

int send(const replay::Recording& recording, const Options& options) {
  replay::ToNetworkOptions target;
  if (options.speed != 0.0 && !(options.speed >= 0.01 && options.speed <= 1000.0)) {
    throw cli::UsageError("--speed: must be from 0.01 to 1000, or 0: as fast as it goes");
  }
  target.speed = options.speed;
  replay::parse_destination("--to-network", options.to_network, target);
  if (!options.imu_to.empty()) {
    replay::parse_imu_destination(options.imu_to, target);
    if (recording.imu_csv.empty()) {
      throw cli::UsageError("--imu-to " + options.imu_to + ": the recording has no file of inertial samples");
    }
  }
  if (!options.gnss_to.empty()) {
    replay::parse_gnss_destination(options.gnss_to, target);
    if (recording.gnss.extension() != ".csv") {
      throw cli::UsageError("--gnss-to " + options.gnss_to + ": the recording has no CSV file of fixes (gnss.source)");
    }
  }
  target.can_interface = options.can_to;
  if (!options.can_to.empty() && recording.imu_can.empty() && recording.wheel_can.empty()) {
    throw cli::UsageError("--can-to " + options.can_to + ": the recording has no candump log");
  }
  cli::catch_interrupts();
  replay::ask_for_punctuality();
  if (!target.imu_terminal.empty()) {
    std::fprintf(stderr, "slamd-replay: %s: waiting for its reader, up to %.0f s\n", target.imu_terminal.c_str(),
                 to_seconds(replay::kReaderPatience));
  }
  if (!target.gnss_terminal.empty()) {
    std::fprintf(stderr, "slamd-replay: %s: waiting for its reader likewise\n", target.gnss_terminal.c_str());
  }
  replay::MonotonicSendClock clock;
  replay::ToNetworkReport report;
  {
    cli::Progress progress("sending");
    report = replay::send_to_network(recording, target, clock, cli::is_interrupted,
                                     [&](double share) { progress.show(share); });
  }
  std::fputs((options.json ? json_of(report) : summary_of(report)).c_str(), stdout);
  return report.interrupted ? 1 : 0;
}

int run(const Options& options) {
  const replay::Recording recording = replay::open_recording(options.recording, options.configs, options.overrides);
  if (options.print_configuration) {
    std::fputs(configuration::print_configuration(recording.configuration).c_str(), stdout);
    return 0;
  }
  if (!options.to_network.empty()) {
    return send(recording, options);
  }
  if (options.out.empty()) {
    throw cli::UsageError("--out DIR is required");
  }
  fs::create_directories(options.out);
  replay::Session session(recording, options.out);
  {
    cli::Progress progress("mapping");
    session.run([&](double share) { progress.show(share); });
  }
  if (!options.compare.empty()) {
    cli::Progress progress("comparing");
    session.compare(options.compare, [&](double share) { progress.show(share); });
  }
  session.write_reports();
  std::fputs((options.json ? session.json() : session.summary()).c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_program(argc, argv, "slamd-replay",
                          "Runs a recording through slamd on a virtual clock: the same recording gives the same bytes.",
                          [&](const cli::Command& app) { declare(app, options); }, [&] { return run(options); });
}
