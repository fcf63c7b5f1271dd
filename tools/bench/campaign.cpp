#include "tools/bench/campaign.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/evaluation/errors.hpp"
#include "tools/replay/output.hpp"
#include "tools/simulate/simulated_source.hpp"

namespace slamd::bench {

using nlohmann::ordered_json;
using simulate::Drive;

namespace {

constexpr double kErrorEvery_s = 1.0;

Campaign campaign_of(const std::string& name, int seeds, double duration_s) {
  Campaign campaign{name, {}};
  for (const std::string& world : simulate::world_names()) {
    for (const simulate::LidarKind lidar : {simulate::LidarKind::kVlp16, simulate::LidarKind::kLivoxAvia}) {
      for (int seed = 1; seed <= seeds; ++seed) {
        Drive drive;
        drive.world = world;
        drive.lidar = lidar;
        drive.seed = static_cast<std::uint64_t>(seed);
        drive.duration_s = duration_s;
        drive.mixed_pixels = true;
        campaign.drives.push_back(drive);
      }
    }
  }
  return campaign;
}

void measure(const evaluation::Trajectory& truth, const evaluation::Trajectory& estimate, Outcome& outcome) {
  const auto pairs = evaluation::associate_interpolated(truth, estimate, std::chrono::seconds(1));
  if (pairs.size() < 3) {
    return;
  }
  evaluation::Similarity similarity = evaluation::align(pairs, evaluation::Alignment::kYaw);
  try {
    similarity = evaluation::align(pairs, evaluation::Alignment::kSe3);
  } catch (const std::invalid_argument&) {
    // A straight path, as through a tunnel: its roll cannot be found.
  }
  outcome.tilt_mean_deg = evaluation::statistics_of(evaluation::tilt_rad(pairs)).mean * 180.0 / M_PI;
  const std::vector<double> errors = evaluation::ape_translation_m(pairs, similarity);
  const evaluation::Statistics statistics = evaluation::statistics_of(errors);
  outcome.ape_rmse_m = statistics.rmse;
  outcome.ape_max_m = statistics.max;
  outcome.end_drift_m = evaluation::end_drift_m(pairs, similarity);
  Stamp next = pairs.front().stamp;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].stamp >= next) {
      outcome.error_m.push_back(std::round(1e5 * errors[i]) / 1e5);
      next += from_seconds(kErrorEvery_s);
    }
  }
}

ordered_json json_of(const Outcome& o) {
  return {{"key", o.key},
          {"world", o.world},
          {"lidar", o.lidar},
          {"seed", o.seed},
          {"duration_s", o.duration_s},
          {"path_m", o.path_m},
          {"scans", o.scans},
          {"scans_tracking", o.scans_tracking},
          {"state", o.state},
          {"ape_rmse_m", o.ape_rmse_m},
          {"ape_max_m", o.ape_max_m},
          {"end_drift_m", o.end_drift_m},
          {"tilt_mean_deg", o.tilt_mean_deg},
          {"cpu_median_ms", o.cpu_median_ms},
          {"cpu_p99_ms", o.cpu_p99_ms},
          {"wall_s", o.wall_s},
          {"error_m", o.error_m}};
}

Outcome outcome_of(const ordered_json& json) {
  Outcome o;
  json.at("key").get_to(o.key);
  json.at("world").get_to(o.world);
  json.at("lidar").get_to(o.lidar);
  json.at("seed").get_to(o.seed);
  json.at("duration_s").get_to(o.duration_s);
  json.at("path_m").get_to(o.path_m);
  json.at("scans").get_to(o.scans);
  json.at("scans_tracking").get_to(o.scans_tracking);
  json.at("state").get_to(o.state);
  json.at("ape_rmse_m").get_to(o.ape_rmse_m);
  json.at("ape_max_m").get_to(o.ape_max_m);
  json.at("end_drift_m").get_to(o.end_drift_m);
  json.at("tilt_mean_deg").get_to(o.tilt_mean_deg);
  json.at("cpu_median_ms").get_to(o.cpu_median_ms);
  json.at("cpu_p99_ms").get_to(o.cpu_p99_ms);
  json.at("wall_s").get_to(o.wall_s);
  json.at("error_m").get_to(o.error_m);
  return o;
}

}  // namespace

Campaign quick_campaign() { return campaign_of("quick", 1, 60.0); }

Campaign full_campaign() { return campaign_of("full", 3, 300.0); }

std::string key_of(const Drive& drive, const std::vector<std::string>& overrides) {
  std::string key = drive.world + "/" + name_of(drive.lidar) + "/" + std::to_string(drive.seed) + "/" +
                    std::to_string(std::lround(drive.duration_s)) + "s";
  for (const std::string& key_value : overrides) {
    key += "/" + key_value;
  }
  return key;
}

Outcome run_drive(const Drive& drive, const std::vector<std::string>& overrides,
                  const std::function<void(double)>& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const simulate::Scene scene(drive);
  simulate::SimulatedSource source(scene);
  const replay::Run run = replay::replay(simulate::configuration_of(drive, overrides), source, {nullptr, progress});
  Outcome outcome;
  outcome.key = key_of(drive, overrides);
  outcome.world = drive.world;
  outcome.lidar = name_of(drive.lidar);
  outcome.seed = drive.seed;
  outcome.duration_s = drive.duration_s;
  outcome.path_m = scene.path_m();
  outcome.scans = run.scans.size();
  std::vector<double> cpu_ms;
  for (const replay::ScanRecord& record : run.scans) {
    outcome.state = name_of(record.odometry.state);
    outcome.scans_tracking += outcome.state == "TRACKING" ? 1 : 0;
    cpu_ms.push_back(record.decode_ms + record.times.preprocess_ms + record.times.odometry_ms);
  }
  const replay::TimeSummary cpu = replay::summary_of(std::move(cpu_ms));
  outcome.cpu_median_ms = cpu.median;
  outcome.cpu_p99_ms = cpu.p99;
  measure(simulate::truth_of(scene.motion()), replay::trajectory_of(run), outcome);
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

std::vector<Outcome> read_results(const std::filesystem::path& file) {
  std::vector<Outcome> results;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const ordered_json json = ordered_json::parse(line, nullptr, false);
    if (json.is_object() && json.contains("tilt_mean_deg")) {
      results.push_back(outcome_of(json));
    }
  }
  return results;
}

std::vector<Outcome> run_campaign(const Campaign& campaign, const std::filesystem::path& directory,
                                  const std::vector<std::string>& overrides,
                                  const std::function<void(double)>& progress) {
  const std::filesystem::path file = directory / "results.jsonl";
  std::vector<Outcome> known = read_results(file);
  std::ofstream stream(file, std::ios::app);
  std::vector<Outcome> outcomes;
  for (const Drive& drive : campaign.drives) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const Outcome& o) { return o.key == key_of(drive, overrides); });
    if (found == known.end()) {
      const auto done = static_cast<double>(outcomes.size());
      const auto total = static_cast<double>(campaign.drives.size());
      outcomes.push_back(run_drive(drive, overrides, [&](double share) { progress((done + share) / total); }));
      stream << json_of(outcomes.back()).dump() << std::endl;
      if (!stream) {
        throw std::runtime_error(file.string() + ": cannot be written");
      }
    } else {
      outcomes.push_back(*found);
    }
  }
  return outcomes;
}

}  // namespace slamd::bench
