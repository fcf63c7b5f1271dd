#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tools/cli/cli.hpp"
#include "tools/ctl/ctl.hpp"

namespace {

using namespace slamd;

/// A large map takes some seconds to be copied between the scans.
constexpr double kSavePatience_s = 30.0;

void declare(const cli::Command& app, ctl::Options& options) {
  app.option("--url", options.url, "LCM's URL, as lcm.url of the daemon").shows_default();
  app.option("--prefix", options.prefix, "Of the channels, as lcm.prefix of the daemon").shows_default();
  app.option("--timeout", options.timeout_s, "How long to wait for the answer, s").within(0.1, 3600.0).shows_default();
  app.require_command();
  const auto add = [&](const char* verb, const char* help, const std::vector<std::string>& names) {
    const cli::Command command = app.command(verb, help);
    command.takes_outer_options();  // --timeout may stand behind, too
    const auto values = std::make_shared<std::vector<std::string>>(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      command.option(names[i], (*values)[i], "").required().unlabelled();
    }
    command.when_given([&options, verb, values] {
      options.command.verb = verb;
      options.command.arguments = *values;
    });
  };
  add("new-map", "Forgets the map and begins a new one here", {});
  add("save", "Saves map and trajectory as a folder of the daemon's output.save_directory", {"NAME"});
  add("set-pose", "Says where base is in map: m, m, m, degrees", {"X", "Y", "Z", "YAW_DEG"});
  add("seal", "Keeps what the black box holds now", {});
  const cli::Command drive = app.command("drive", "Moves a simulated vehicle (slamd-simulate --drive) for a time, then stops it");
  drive.takes_outer_options();
  drive.option("V", options.velocity.v_mps, "m/s ahead").required().within(-100.0, 100.0);
  drive.option("W", options.velocity.w_radps, "rad/s to the left").required().within(-100.0, 100.0);
  drive.option("SECONDS", options.drive_s, "how long").required().within(0.0, 3600.0);
  drive.when_given([&options] { options.drives = true; });
  app.footer("Exit: 0 done, 1 refused or no answer, 2 bad usage.");
}

int run(ctl::Options& options) {
  if (!bus::is_prefix(options.prefix)) {
    throw cli::UsageError("--prefix: 1 to 40 letters, digits, '_' and '-'");
  }
  std::random_device random;
  if (options.command.verb == "save") {
    options.timeout_s = std::max(options.timeout_s, kSavePatience_s);
  }
  options.command.id = std::uint64_t{random()} << 32U | random();
  bus::Connection connection(options.url);
  if (options.drives) {
    ctl::drive(connection, options.prefix, options.velocity, options.drive_s, [](auto time) { std::this_thread::sleep_for(time); });
    return 0;
  }
  const bus::Reply reply = ctl::ask(connection, options);
  std::printf("%s%s\n", reply.ok ? "" : "refused: ", ctl::printable(reply.text).c_str());
  return reply.ok ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  ctl::Options options;
  return cli::run_program(argc, argv, "slamd-ctl", "Gives an order to a running slamd and prints its answer.",
                          [&](const cli::Command& app) { declare(app, options); }, [&] { return run(options); });
}
