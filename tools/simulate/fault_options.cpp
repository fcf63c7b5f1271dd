#include "tools/simulate/fault_options.hpp"

#include <cmath>

#include <CLI/CLI.hpp>

#include "tools/cli/cli.hpp"

namespace slamd::simulate {

namespace {

/// Reads a number and returns what follows it. Errors: UsageError.
double number(const std::string& option, const std::string& text, std::string& rest) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || !std::isfinite(value)) {
    throw cli::UsageError(option + " " + text + ": is no number");
  }
  rest = end;
  return value;
}

double share(const std::string& option, const std::string& text) {
  if (text.empty()) {
    return 0.0;
  }
  std::string unit;
  const double value = number(option, text, unit) * (unit == "%" ? 0.01 : 1.0);
  if ((unit != "%" && !unit.empty()) || value < 0.0 || value > 1.0) {
    throw cli::UsageError(option + " " + text + ": is no share between 0 and 100%");
  }
  return value;
}

double seconds(const std::string& option, const std::string& text) {
  if (text.empty()) {
    return 0.0;
  }
  std::string unit;
  const double value = number(option, text, unit);
  if (unit == "us") {
    return 1e-6 * value;
  }
  if (unit == "ms") {
    return 1e-3 * value;
  }
  if (unit == "s" || unit.empty()) {
    return value;
  }
  throw cli::UsageError(option + " " + text + ": is no time (as 8ms, 0.5s)");
}

/// Splits "a<mark>b". Errors: UsageError.
std::pair<std::string, std::string> halves(const std::string& option, const std::string& text, char mark,
                                           const char* form) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) {
    throw cli::UsageError(option + " " + text + ": is not of the form " + form);
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

std::vector<Event> events(const std::string& option, const std::vector<std::string>& texts) {
  std::vector<Event> list;
  for (const std::string& text : texts) {
    const auto [by, at] = halves(option, text, '@', "TIME@MOMENT, as 2s@30");
    list.push_back({seconds(option, at), seconds(option, by)});
  }
  return list;
}

}  // namespace

void declare(CLI::App& app, FaultOptions& options) {
  app.add_option("IN", options.in, "Recording (directory, or capture)")->required();
  app.add_option("OUT", options.out, "Directory of the damaged copy")->required();
  app.add_flag("--force", options.force, "Write into a directory that is not empty");
  app.add_option("--seed", options.faults.seed, "Of everything that is left to chance")->capture_default_str();
  app.add_option("--drop", options.drop, "Share of all packets that are lost, as 1%");
  app.add_option("--burst", options.burst, "COUNTxPACKETS, as 3x50: bursts of packets lost in a row");
  app.add_option("--reorder", options.reorder, "Share of point packets that come one to three packets late");
  app.add_option("--duplicate", options.duplicate, "Share of point packets that come twice");
  app.add_option("--truncate", options.truncate, "Share of all packets that lose their end");
  app.add_option("--garbage", options.garbage, "Share of all packets whose bytes are noise");
  app.add_option("--clock-step", options.clock_steps, "TIME@MOMENT, as -0.5s@30: the LiDAR's clock jumps")->take_all();
  app.add_option("--blackout", options.blackouts, "TIME@MOMENT, as 2s@30: no LiDAR packet")->take_all();
  app.add_option("--imu-gap", options.imu_gaps, "TIME@MOMENT, as 0.3s@20: no inertial sample")->take_all();
  app.add_option("--imu-offset", options.imu_offset, "Added to every inertial stamp, as 8ms");
  app.add_option("--imu-clip", options.imu_clip, "RADPS,MPS2, as 1.5,15: what the inertial sensor can say at most");
  app.add_option("--block-fov", options.block_fov,
                 "FROM:TO in degrees to the left of ahead, as 160:200: nothing is seen there");
  app.footer(
      "Moments count from the recording's first packet. OUT/faults.json says what was done, and what report.json must "
      "count.");
}

Faults faults_of(const FaultOptions& options) {
  Faults faults = options.faults;
  faults.drop = share("--drop", options.drop);
  faults.reorder = share("--reorder", options.reorder);
  faults.duplicate = share("--duplicate", options.duplicate);
  faults.truncate = share("--truncate", options.truncate);
  faults.garbage = share("--garbage", options.garbage);
  if (faults.reorder + faults.duplicate > 1.0 || faults.truncate + faults.garbage > 1.0) {
    throw cli::UsageError(
        "shares of --reorder and --duplicate, and of --truncate and --garbage, must not exceed 100% together");
  }
  std::string rest;
  if (!options.burst.empty()) {
    const auto [count, packets] = halves("--burst", options.burst, 'x', "COUNTxPACKETS");
    faults.burst = {static_cast<int>(number("--burst", count, rest)),
                    static_cast<int>(number("--burst", packets, rest))};
  }
  faults.clock_steps = events("--clock-step", options.clock_steps);
  faults.blackouts = events("--blackout", options.blackouts);
  faults.imu_gaps = events("--imu-gap", options.imu_gaps);
  faults.imu_offset_s = seconds("--imu-offset", options.imu_offset);
  if (!options.imu_clip.empty()) {
    const auto [rate, force] = halves("--imu-clip", options.imu_clip, ',', "RADPS,MPS2");
    faults.imu_clip = InertialLimits{number("--imu-clip", rate, rest), number("--imu-clip", force, rest)};
  }
  if (!options.block_fov.empty()) {
    const auto [from, to] = halves("--block-fov", options.block_fov, ':', "FROM:TO");
    faults.block_fov = Sector{number("--block-fov", from, rest), number("--block-fov", to, rest)};
  }
  return faults;
}

}  // namespace slamd::simulate
