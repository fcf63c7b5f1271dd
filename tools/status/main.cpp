#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "daemon/bus/channels.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/cli/cli.hpp"
#include "tools/status/dashboard.hpp"
#include "tools/status/json.hpp"
#include "tools/status/listener.hpp"

namespace {

using namespace slamd;
using status::Clock;

constexpr std::chrono::milliseconds kRedraw{500};

struct Options {
  std::string url{bus::kDefaultUrl};
  std::string prefix{bus::kDefaultPrefix};
  double timeout_s = 2.0;
  std::string tum;
  std::string truth;
  bool once = false;
  bool json = false;
};

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File file_of(const std::string& name) {
  File file(std::fopen(name.c_str(), "wb"), std::fclose);
  if (!file) {
    throw std::runtime_error(name + ": cannot be written");
  }
  return file;
}

/// Writes every pose as a line of a TUM trajectory, T_odom_base.
File record_poses(const std::string& name, status::Listener& listener) {
  File file = file_of(name);
  listener.on_pose([stream = file.get()](const bus::Pose& pose) { recording::write_tum_line(stream, pose.stamp, pose.T_odom_base); });
  return file;
}

/// Writes where a driven simulation's vehicle is, T_world_base.
File record_truth(const std::string& name, status::Listener& listener) {
  File file = file_of(name);
  listener.on_truth([stream = file.get()](const bus::Truth& truth) { recording::write_tum_line(stream, truth.stamp, truth.T_world_base); });
  return file;
}

volatile std::sig_atomic_t stop = 0;

void declare(const cli::Command& app, Options& options) {
  app.option("--url", options.url, "LCM's URL, as lcm.url of the daemon").shows_default();
  app.option("--prefix", options.prefix, "Of the channels, as lcm.prefix of the daemon").shows_default();
  app.flag("--once", options.once, "Print one picture when health is heard, and exit");
  app.option("--tum", options.tum, "Also write every pose that is heard to this TUM file, until interrupted").value_name("FILE");
  app.option("--truth", options.truth, "Also write where a simulated vehicle is (slamd-simulate --drive, --live) to this TUM file")
      .value_name("FILE");
  app.flag("--json", options.json, "Print JSON, one line each time");
  app.option("--timeout", options.timeout_s, "How long --once waits for health, s").within(0.1, 3600.0).shows_default();
  app.footer("Exit: 0 TRACKING; 3 heard, but another state; 1 no health heard, or no way to LCM; 2 bad usage.\n"
             "Without --once it runs until interrupted, and the last health heard counts.");
}

status::Look look_of(const Options& options) {
  status::Look look{.url = options.url, .prefix = options.prefix};
  winsize size{};
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  if (!terminal || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0 || size.ws_col == 0) {
    size.ws_row = options.once ? 1000 : 24;
    size.ws_col = options.once ? 1000 : 80;
  }
  const char* no_colour = std::getenv("NO_COLOR");
  look.colour = terminal && (no_colour == nullptr || *no_colour == '\0');
  look.rows = size.ws_row;
  look.columns = size.ws_col;
  return look;
}

void print(const status::Heard& heard, const Options& options, const char* before) {
  const std::string text =
      options.json ? status::to_json(heard, Clock::now()) : before + status::draw(heard, Clock::now(), look_of(options));
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

int run(const Options& options) {
  if (!bus::is_prefix(options.prefix)) {
    throw cli::UsageError("--prefix: 1 to 40 letters, digits, '_' and '-'");
  }
  bus::Connection connection(options.url);
  status::Listener listener(connection, options.prefix);
  const File trajectory = options.tum.empty() ? File(nullptr, std::fclose) : record_poses(options.tum, listener);
  const File truth = options.truth.empty() ? File(nullptr, std::fclose) : record_truth(options.truth, listener);
  if (options.once) {
    const auto timeout = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_s));
    listener.listen_for_health(Clock::now() + timeout);
    listener.listen_until(Clock::now() + std::chrono::milliseconds(listener.heard().pose.message ? 0 : 50));
    print(listener.heard(), options, "");
    return status::exit_code_of(listener.heard());
  }
  struct sigaction action {};
  action.sa_handler = [](int) { stop = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  const char* before = isatty(STDOUT_FILENO) != 0 ? "\033[H\033[J" : "";
  while (stop == 0) {
    listener.listen_until(Clock::now() + kRedraw);
    print(listener.heard(), options, before);
  }
  return status::exit_code_of(listener.heard());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_program(argc, argv, "slamd-status", "Shows how a running slamd is.",
                          [&](const cli::Command& app) { declare(app, options); }, [&] { return run(options); });
}
