#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "daemon/configuration/loader.hpp"
#include "drivers/transport/udp_receiver.hpp"
#include "tools/cli/cli.hpp"
#include "tools/cli/interrupts.hpp"
#include "tools/sensors/json.hpp"
#include "tools/sensors/listening.hpp"
#include "tools/sensors/remarks.hpp"
#include "tools/sensors/starting_configuration.hpp"
#include "tools/sensors/table.hpp"

namespace {

using namespace slamd;

constexpr Duration kTick = std::chrono::milliseconds(50);  // serial lines look at their time as often

struct Options {
  double seconds = 15.0;
  bool json = false;
  std::string config;
  std::string write;
  bool force = false;
  bool no_serial = false;
  std::vector<std::string> avias;
  sensors::ListeningConfig listening;
};

void declare(const cli::Command& app, Options& options) {
  app.option("--seconds", options.seconds, "How long to listen, s; 0: until interrupted. All rates of a serial line take 12")
      .within(0.0, 86400.0).shows_default();
  app.flag("--json", options.json, "Print JSON, one line each second");
  app.option("--config", options.config, "A configuration: listen where it has sensors, and tell whether gravity is where it has it").value_name("FILE");
  const cli::Option write = app.option("--write", options.write, "At the end, write a configuration to begin with").value_name("FILE");
  app.flag("--force", options.force, "Let --write replace a file").needs(write);
  app.option("--serial", options.listening.serial, "A serial line to listen to, beside the adapters that are plugged in").value_name("DEVICE");
  app.flag("--no-serial", options.no_serial, "Leave the adapters that are plugged in alone");
  app.option("--can", options.listening.can, "A CAN interface to listen to, beside those that are there").value_name("INTERFACE");
  app.option("--port", options.listening.ports, "A UDP port to listen at, beside the sensors' own").value_name("PORT").within(1, 65535);
  app.flag("--ask", options.listening.asks, "Ask, too: a Mid-360 where it sends to, and what is mute on serial lines who it is");
  app.option("--ask-avia", options.avias, "Ask the Avia at this address whether it has a host: one that has none is let go at once").value_name("ADDRESS");
  app.footer("It listens: no device is held or set, and no line taken from slamd. Only who has a Livox SDK2 device is asked.\n"
             "Exit: 0 something was found; 1 nothing was, or --write could not be done; 2 bad usage or configuration.");
}

sensors::Look look_of_terminal() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0 || size.ws_col == 0) {
    return {};
  }
  return {size.ws_row, size.ws_col};
}

void show(const sensors::Seen& seen, const std::vector<sensors::Remark>& remarks, const Options& options, bool is_terminal) {
  const std::string text = options.json    ? sensors::to_json(seen, remarks)
                           : is_terminal ? "\033[H\033[J" + sensors::draw(seen, remarks, look_of_terminal())
                                           : sensors::second_as_lines(seen);
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

std::string date() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

std::optional<configuration::Configuration> load(const std::string& file) {
  if (file.empty()) {
    return std::nullopt;
  }
  configuration::Loader loader;
  loader.add_file(file);
  return loader.load();
}

int run(const Options& options) {
  const std::optional<configuration::Configuration> configuration = load(options.config);
  if (!options.write.empty() && !options.force && access(options.write.c_str(), F_OK) == 0) {
    throw cli::UsageError("--write " + options.write + ": is there already; --force replaces it");
  }
  sensors::ListeningConfig config = options.listening;
  config.finds_serial = !options.no_serial;
  if (configuration) {
    add_places_of(*configuration, config);
  }
  for (const std::string& avia : options.avias) {
    const auto address = transport::parse_address(avia);
    if (!address) {
      throw cli::UsageError("--ask-avia " + avia + ": must be an IPv4 address with dots");
    }
    config.avias.push_back(*address);
  }
  const transport::HostClock clock;
  sensors::Listening listening(config, clock);
  const bool is_terminal = isatty(STDOUT_FILENO) != 0;
  const Stamp end = options.seconds == 0.0 ? Stamp::max() : clock.now() + from_seconds(options.seconds);
  Stamp next_second = clock.now() + std::chrono::seconds(1);
  cli::catch_interrupts();
  while (!cli::is_interrupted() && clock.now() < end) {
    listening.run_once(kTick);
    if (clock.now() >= next_second) {
      next_second += std::chrono::seconds(1);
      listening.end_second();
      const sensors::Seen seen = listening.seen();
      show(seen, remarks_of(seen, configuration), options, is_terminal);
    }
  }
  const sensors::Seen seen = listening.seen();
  if (!options.json && !is_terminal) {
    std::fputs(sensors::remarks_as_lines(remarks_of(seen, configuration)).c_str(), stdout);
  }
  if (!options.write.empty()) {
    sensors::write_file(options.write, starting_configuration(seen, date()), options.force);
    if (!options.json) {
      std::printf("written: %s\n", options.write.c_str());
    }
  }
  return seen.anything() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_program(argc, argv, "slamd-sensors", "Finds what sensors are connected, and says what is wrong with them.",
                          [&](const cli::Command& app) { declare(app, options); }, [&] { return run(options); });
}
