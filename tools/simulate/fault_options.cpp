#include "tools/simulate/fault_options.hpp"

#include <cmath>

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

/// Reads a time, which is a part of what was `given` to the option.
double seconds(const std::string& option, const std::string& text, const std::string& given) {
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
  throw cli::UsageError(option + " " + given + ": is no time (as 8ms, 0.5s)");
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

/// Two numbers of "a<mark>b", with nothing behind them. Errors: UsageError.
std::pair<double, double> two_numbers(const std::string& option, const std::string& text, char mark, const char* form) {
  const auto [first, second] = halves(option, text, mark, form);
  std::string rest_of_first;
  std::string rest_of_second;
  const double a = number(option, first, rest_of_first);
  const double b = number(option, second, rest_of_second);
  if (!rest_of_first.empty() || !rest_of_second.empty()) {
    throw cli::UsageError(option + " " + text + ": is not of the form " + form);
  }
  return {a, b};
}

enum class Sign { kAny, kPositive };

std::vector<Event> events(const std::string& option, const std::vector<std::string>& texts, Sign sign) {
  std::vector<Event> list;
  for (const std::string& text : texts) {
    const auto [by, at] = halves(option, text, '@', "TIME@MOMENT, as 2s@30");
    if (by.empty() || at.empty()) {
      throw cli::UsageError(option + " " + text + ": is not of the form TIME@MOMENT, as 2s@30");
    }
    list.push_back({seconds(option, at, text), seconds(option, by, text)});
    if (list.back().at_s < 0.0 || (sign == Sign::kPositive && list.back().by_s <= 0.0)) {
      throw cli::UsageError(option + " " + text + ": must lie after the beginning and last some time");
    }
  }
  return list;
}

Bursts bursts(const std::string& text) {
  const auto [count, packets] = two_numbers("--burst", text, 'x', "COUNTxPACKETS, as 3x50");
  const auto is_count = [](double value) { return value >= 1.0 && value <= 1e6 && value == std::floor(value); };
  if (!is_count(count) || !is_count(packets)) {
    throw cli::UsageError("--burst " + text + ": must be two whole numbers from 1 to 1000000, as 3x50");
  }
  return {static_cast<int>(count), static_cast<int>(packets)};
}

}  // namespace

void declare(const cli::Command& app, FaultOptions& options) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    app.option(name, value, help).take_all();
  };
  const auto add_one = [&](const char* name, std::string& value, const char* help) {
    app.option(name, value, help);
  };
  add_one("--drop", options.drop, "Share of all packets that are lost, as 1%");
  add_one("--burst", options.burst, "COUNTxPACKETS, as 3x50: bursts of packets lost in a row");
  add_one("--reorder", options.reorder, "Share of point packets that come one to three packets late");
  add_one("--duplicate", options.duplicate, "Share of point packets that come twice");
  add_one("--truncate", options.truncate, "Share of all packets that lose their end");
  add_one("--garbage", options.garbage, "Share of all packets whose bytes are noise");
  add("--clock-step", options.clock_steps, "TIME@MOMENT, as -0.5s@30: the LiDAR's clock jumps");
  add("--blackout", options.blackouts, "TIME@MOMENT, as 2s@30: no LiDAR packet");
  add("--imu-gap", options.imu_gaps, "TIME@MOMENT, as 0.3s@20: no inertial sample");
  add_one("--imu-offset", options.imu_offset, "Added to every inertial stamp, as 8ms");
  add_one("--imu-clip", options.imu_clip, "RADPS,MPS2, as 1.5,15: what the inertial sensor can say at most");
  add_one("--block-fov", options.block_fov,
          "FROM:TO in degrees to the left of ahead, as 160:200: nothing is seen there");
}

void declare(const cli::Command& app, FaultCommand& command) {
  app.option("IN", command.in, "Recording (directory, or capture)").required();
  app.option("OUT", command.out, "Directory of the damaged copy").required();
  app.flag("--force", command.force, "Write into a directory that is not empty");
  app.option("--seed", command.seed, "Of everything that is left to chance").shows_default();
  declare(app.under("Faults"), command.faults);
  app.footer(
      "Moments count from the recording's first packet. OUT/faults.json says what was done, and what report.json must "
      "count.");
}

Faults faults_of(const FaultOptions& options, std::uint64_t seed) {
  Faults faults;
  faults.seed = seed;
  faults.drop = share("--drop", options.drop);
  faults.reorder = share("--reorder", options.reorder);
  faults.duplicate = share("--duplicate", options.duplicate);
  faults.truncate = share("--truncate", options.truncate);
  faults.garbage = share("--garbage", options.garbage);
  if (faults.reorder + faults.duplicate > 1.0 || faults.truncate + faults.garbage > 1.0) {
    throw cli::UsageError(
        "shares of --reorder and --duplicate, and of --truncate and --garbage, must not exceed 100% together");
  }
  if (!options.burst.empty()) {
    faults.burst = bursts(options.burst);
  }
  faults.clock_steps = events("--clock-step", options.clock_steps, Sign::kAny);
  faults.blackouts = events("--blackout", options.blackouts, Sign::kPositive);
  faults.imu_gaps = events("--imu-gap", options.imu_gaps, Sign::kPositive);
  faults.imu_offset_s = seconds("--imu-offset", options.imu_offset, options.imu_offset);
  if (!options.imu_clip.empty()) {
    const auto [rate, force] = two_numbers("--imu-clip", options.imu_clip, ',', "RADPS,MPS2, as 1.5,15");
    if (rate < 0.0 || force < 0.0) {
      throw cli::UsageError("--imu-clip " + options.imu_clip + ": must not be negative (0: no limit)");
    }
    faults.imu_clip = InertialLimits{rate, force};
  }
  if (!options.block_fov.empty()) {
    const auto [from, to] = two_numbers("--block-fov", options.block_fov, ':', "FROM:TO, as 160:200");
    if (std::abs(from) > 360.0 || std::abs(to) > 360.0) {
      throw cli::UsageError("--block-fov " + options.block_fov + ": must be degrees from -360 to 360");
    }
    faults.block_fov = Sector{from, to};
  }
  return faults;
}

bool asks_for_any(const FaultOptions& options) {
  for (const std::string* text : {&options.drop, &options.reorder, &options.duplicate, &options.truncate,
                                  &options.garbage, &options.burst, &options.imu_offset, &options.imu_clip,
                                  &options.block_fov}) {
    if (!text->empty()) {
      return true;
    }
  }
  return !options.clock_steps.empty() || !options.blackouts.empty() || !options.imu_gaps.empty();
}

}  // namespace slamd::simulate
