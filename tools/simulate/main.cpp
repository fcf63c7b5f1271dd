#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "tools/cli/cli.hpp"
#include "tools/cli/interrupts.hpp"
#include "tools/replay/session.hpp"
#include "tools/simulate/fault_options.hpp"
#include "tools/simulate/live_device.hpp"
#include "tools/simulate/options.hpp"
#include "tools/simulate/preview.hpp"
#include "tools/simulate/simulate.hpp"
#include "tools/simulate/simulated_source.hpp"

namespace {

namespace fs = std::filesystem;
using namespace slamd;

/// Makes the directory of what is to be written. Errors: UsageError when it holds something already.
void make_directory(const std::string& out, bool force) {
  if (out.empty()) {
    throw cli::UsageError("--out DIR is required (try --help)");
  }
  if (fs::exists(out) && (!fs::is_directory(out) || (!fs::is_empty(out) && !force))) {
    throw cli::UsageError(out + ": is not empty (--force writes into it all the same)");
  }
  fs::create_directories(out);
}

/// Writes the picture that --preview asks for.
void write_preview(const simulate::Drive& drive, const std::string& file) {
  const std::vector<std::byte> png = plot::png_of(simulate::preview_of(simulate::Scene(drive)));
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  if (!stream.flush()) {
    throw std::runtime_error(file + ": cannot be written");
  }
}

/// Maps a drive without writing it.
int run_replay(const simulate::Drive& drive, const std::string& out) {
  const simulate::Scene scene(drive);
  simulate::SimulatedSource source(scene);
  replay::Recording recording;
  recording.name = out;
  recording.configuration = simulate::configuration_of(drive, {});
  replay::Session session(std::move(recording), out);
  {
    cli::Progress progress("simulating and mapping");
    session.run(source, simulate::truth_of(scene.motion()), [&](double share) { progress.show(share); });
  }
  session.write_reports();
  if (source.faults() != nullptr) {
    simulate::write_faults(*drive.faults, *source.faults(), fs::path(out) / "faults.json");
  }
  std::fputs(session.summary().c_str(), stdout);
  return 0;
}

/// Drives by commands; ends well when the user ends it.
int run_drive(const simulate::Drive& drive, const simulate::Options& options) {
  const simulate::LiveOptions live = live_options_of(options);
  if (!options.out.empty()) {
    make_directory(options.out, options.force);
  }
  cli::catch_interrupts();
  replay::ask_for_punctuality();
  replay::MonotonicSendClock clock;
  simulate::LiveReport report;
  {
    cli::Progress progress("driving");
    const std::function<void(const std::string&)> say = [&](const std::string& text) {
      progress.say("slamd-simulate: " + text);
    };
    std::optional<simulate::LiveDevice> device;
    if (options.live) {
      device.emplace(drive, device_options_of(options), clock, say);
    }
    report = simulate::drive_live(drive, live, clock, cli::is_interrupted, [&](double share) { progress.show(share); }, say,
                                  device ? &*device : nullptr);
    if (device) {
      say(device->summary());
      report.device = device->report();
    }
  }
  std::fputs((options.json ? json_of(report) : summary_of(report)).c_str(), stdout);
  return 0;
}

int run_simulation(const simulate::Options& options) {
  const simulate::Drive drive = drive_of(options);
  if (drive.driven) {
    return run_drive(drive, options);
  }
  if (!options.preview.empty()) {
    write_preview(drive, options.preview);
    if (options.out.empty()) {
      return 0;
    }
  }
  make_directory(options.out, options.force);
  if (options.replay) {
    return run_replay(drive, options.out);
  }
  simulate::Summary summary;
  {
    cli::Progress progress("simulating");
    summary = simulate::simulate(drive, options.out, [&](double share) { progress.show(share); });
  }
  std::printf("%s: %s in %s %llu, %.0f s, %.0f m, %llu packets, %.1f million rays\n", options.out.c_str(),
              options.lidar.c_str(), drive.mesh.empty() ? drive.world.c_str() : drive.mesh.c_str(),
              static_cast<unsigned long long>(drive.seed), drive.duration_s, summary.path_m,
              static_cast<unsigned long long>(summary.packets), 1e-6 * static_cast<double>(summary.rays));
  return 0;
}

int run_faults(const simulate::FaultCommand& options) {
  const simulate::Faults faults = faults_of(options.faults, options.seed);
  make_directory(options.out, options.force);
  simulate::FaultCounts counts;
  {
    cli::Progress progress("damaging");
    counts = simulate::inject_faults(options.in, options.out, faults, [&](double share) { progress.show(share); });
  }
  std::fputs(simulate::faults_json(faults, counts).c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  simulate::Options options;
  simulate::FaultCommand fault_command;
  cli::Command faults;
  return cli::run_program(
      argc, argv, "slamd-simulate", "Simulates a drive with exact truth as a recording of raw packets.",
      [&](const cli::Command& app) {
        declare(app, options);
        faults = app.command("faults", "Damages a copy of any recording");
        declare(faults, fault_command);
      },
      [&] { return faults.is_given() ? run_faults(fault_command) : run_simulation(options); });
}
