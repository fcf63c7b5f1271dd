#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/configuration/key_table.hpp"
#include "tools/cli/cli.hpp"
#include "tools/replay/session.hpp"

namespace {

namespace fs = std::filesystem;
using namespace slamd;

struct Options {
  std::string recording;
  std::string out;
  std::vector<std::string> configs;
  std::vector<std::string> overrides;
  std::string compare;
  bool json = false;
  bool print_configuration = false;
};

void declare(CLI::App& app, Options& options) {
  app.add_option("RECORDING", options.recording, "Directory with recording.toml, or a capture with --config")->required();
  app.add_option("--out", options.out, "Directory for odometry.tum, trajectory.tum, map.ply, report.json, report.html");
  app.add_option("--config", options.configs, "TOML file; wins over recording.toml key by key");
  app.add_option("--set", options.overrides, "key=value; wins over all files")->take_all();
  app.add_option("--compare", options.compare, "Run a second filter on the same recording, side by side")->check(CLI::IsMember({"psf", "iekf"}));
  app.add_flag("--json", options.json, "Print report.json instead of the summary");
  app.add_flag("--print-config", options.print_configuration, "Print the complete configuration and exit");
  app.add_flag_callback(
         "--print-keys",
         [] {
           std::fputs(configuration::print_reference().c_str(), stdout);
           std::exit(0);
         },
         "Print a table of all keys and exit")
      ->trigger_on_parse();
  app.footer("Exit code: 0 the recording was processed to its end; 1 it could not be; 2 bad configuration or usage.\n"
             "All keys: docs/configuration.md.");
}

int run(const Options& options) {
  const replay::Recording recording = replay::open_recording(options.recording, options.configs, options.overrides);
  if (options.print_configuration) {
    std::fputs(configuration::print_configuration(recording.configuration).c_str(), stdout);
    return 0;
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
                          [&](CLI::App& app) { declare(app, options); }, [&] { return run(options); });
}
