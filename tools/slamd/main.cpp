#include <cstdio>
#include <string>
#include <vector>

#include "daemon/configuration/key_table.hpp"
#include "daemon/configuration/loader.hpp"
#include "daemon/service/service.hpp"
#include "tools/cli/cli.hpp"

namespace {

using namespace slamd;

struct Options {
  std::vector<std::string> files;
  std::vector<std::string> overrides;
  bool check = false;
  bool validate = false;
  bool print_config = false;
  bool memory_plan = false;
};

void declare(const cli::Command& app, Options& options) {
  app.option("--config", options.files, "TOML file; later ones win key by key").value_name("FILE");
  app.option("--set", options.overrides, "key=value; wins over all files").value_name("KEY=VALUE");
  app.flag("--check", options.check, "Tell whether slamd could start here, and what it would lack; exit 0, 1 or 2");
  app.flag("--validate", options.validate, "Only read the configuration: exit 0, or 2 and what is wrong with it");
  app.flag("--print-config", options.print_config, "Print the complete configuration and exit");
  app.flag("--memory-plan", options.memory_plan, "Print what is reserved at start and exit");
  app.footer("Exit code: 0 ended by a signal; 1 could not start; 2 bad configuration or usage.\n"
             "SIGTERM and SIGINT end it; SIGHUP has it read its configuration again.\n"
             "All keys: slamd.toml(5), docs/configuration.md. Messages: docs/protocol.md.");
}

configuration::Configuration read(const Options& options) {
  configuration::Loader loader;
  if (options.files.empty() && options.overrides.empty()) {
    throw cli::UsageError("no configuration: --config FILE (or --set lidar.model=vlp16)");
  }
  for (const std::string& file : options.files) {
    loader.add_file(file);
  }
  for (const std::string& key_value : options.overrides) {
    loader.add_override(key_value);
  }
  return loader.load();
}

int run(const Options& options) {
  const configuration::Configuration configuration = read(options);
  if (options.validate) {
    return 0;
  }
  if (options.print_config) {
    std::fputs(configuration::print_configuration(configuration).c_str(), stdout);
    return 0;
  }
  if (options.memory_plan) {
    std::fputs(service::memory_plan_text(configuration).c_str(), stdout);
    return 0;
  }
  return options.check ? service::check(configuration) : service::serve(configuration, [&] { return read(options); });
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_program(argc, argv, "slamd", "LiDAR-inertial SLAM service: sensors in, poses, scans and health out over LCM.",
                          [&](const cli::Command& app) { declare(app, options); }, [&] { return run(options); });
}
