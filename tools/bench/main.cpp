#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tools/bench/campaign_page.hpp"
#include "tools/bench/graph_table.hpp"
#include "tools/bench/neighbour_peers.hpp"
#include "tools/bench/neighbour_speed.hpp"
#include "tools/bench/occupancy_speed.hpp"
#include "tools/bench/own_network.hpp"
#include "tools/bench/pose_latency.hpp"
#include "tools/bench/ray_speed.hpp"
#include "tools/cli/cli.hpp"
#include "tools/simulate/scenery.hpp"
#include "tools/study/study_page.hpp"

namespace {

namespace fs = std::filesystem;
using namespace slamd;

struct Options {
  std::string size;
  std::string out;
  std::vector<std::string> overrides;
  std::uint64_t seed = 1;
  bench::PoseLatencyConfig pose;
  study::StudyConfig study;
  bench::GraphBenchConfig graph;
  std::string experiment = "both";
  std::string prior = "both";
  bool json = false;
  int scans = 20;
};

void write(const std::string& text, const fs::path& file) {
  std::ofstream stream(file);
  stream << text;
  if (!stream.flush()) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

int run_campaign(const Options& options) {
  const bench::Campaign campaign = options.size == "full" ? bench::full_campaign() : bench::quick_campaign();
  fs::create_directories(options.out);
  std::vector<bench::Outcome> outcomes;
  {
    cli::Progress progress("campaign");
    outcomes =
        bench::run_campaign(campaign, options.out, options.overrides, [&](double share) { progress.show(share); });
  }
  const std::string table = bench::table_of(outcomes);
  write(table, fs::path(options.out) / "table.txt");
  write(bench::page_of(campaign.name, outcomes), fs::path(options.out) / "campaign.html");
  std::fputs(table.c_str(), stdout);
  return 0;
}

int run_rays(const Options& options) {
  std::printf("%-10s %14s %15s\n", "world", "caster Mray/s", "packets Mray/s");
  for (const std::string& world : simulate::world_names()) {
    const bench::RaySpeed speed = bench::measure_ray_speed(world, options.seed, 1.0);
    std::printf("%-10s %14.2f %15.2f\n", world.c_str(), speed.caster, speed.packets);
    std::fflush(stdout);
  }
  return 0;
}

int run_occupancy(const Options& options) {
  std::printf("%-10s %6s %7s %7s %11s %9s %9s %8s %9s\n", "world", "cell m", "blocks", "points", "insert ms", "p99", "tell ms", "changed", "kB/s");
  for (const std::string& world : simulate::world_names()) {
    for (const double cell_m : {0.2, 0.1}) {
      const bench::OccupancySpeed speed = bench::measure_occupancy(world, options.seed, options.scans, cell_m);
      std::printf("%-10s %6.1f %7zu %7.0f %11.2f %9.2f %9.2f %8.0f %9.0f\n", world.c_str(), cell_m, speed.blocks, speed.points,
                  speed.insert_median_ms, speed.insert_p99_ms, speed.tell_median_ms, speed.changed_blocks, 1e-3 * speed.bytes_per_s);
      std::fflush(stdout);
    }
  }
  return 0;
}

int run_pose_latency(Options& options) {
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  options.pose.slamd = programs / "slamd";
  options.pose.padding = programs.parent_path() / "lib" / "libslamd_padded_pose.so";
  for (const fs::path& file : {options.pose.slamd, options.pose.padding}) {
    if (!fs::exists(file)) {
      throw std::runtime_error(file.string() + ": does not exist");
    }
  }
  const bool alone = bench::enter_own_network();
  std::vector<bench::PoseLatencyRow> rows;
  {
    cli::Progress progress("pose latency");
    rows = bench::measure_pose_latency(options.pose, [&](double share) { progress.show(share); });
  }
  if (options.json) {
    std::fputs(bench::json_of(rows, options.pose.pose_bytes, options.pose.imu_rate_hz).c_str(), stdout);
  } else {
    std::printf("VLP-16 and %.0f Hz IMU for %.0f s a row, poses of %zu bytes, %s; from the sample's sending to the subscriber\n%s",
                options.pose.imu_rate_hz, options.pose.seconds, options.pose.pose_bytes,
                alone ? "a network of their own" : "this computer's network", bench::table_of(rows).c_str());
  }
  return 0;
}

int run_neighbours(const Options& options) {
  if (bench::neighbour_peers().empty()) {
    throw std::runtime_error("built without PCL and nanoflann to compare with: tools/setup --bench installs them; "
                             "configure and build again");
  }
  for (const bench::NeighbourCase& sizes : bench::neighbour_cases()) {
    bench::NeighbourTable table;
    {
      cli::Progress progress(sizes.name);
      table = bench::measure_neighbours(sizes, options.seed, options.scans, [&](double share) { progress.show(share); });
    }
    std::fputs(bench::text_of(table).c_str(), stdout);
    std::fflush(stdout);
  }
  return 0;
}

void write_study(const study::StudyConfig& config, const std::vector<study::WorldResult>& results, const fs::path& out) {
  write(study::markdown_of(config, results), out / "psf-study.md");
  write(study::json_of(config, results), out / "psf-study.json");
  if (config.registration) {
    write(study::svg_of(study::Experiment::kRegistration, results), out / "psf-study-registration.svg");
  }
  if (config.tracking) {
    write(study::svg_of(study::Experiment::kTracking, results), out / "psf-study-tracking.svg");
  }
}

int run_psf_study(Options& options) {
  study::StudyConfig& config = options.study;
  if (config.worlds.empty()) {
    config.worlds = simulate::world_names();
  }
  config.seed = options.seed;
  config.registration = options.experiment != "tracking";
  config.tracking = options.experiment != "registration";
  config.not_told = options.prior != "told";
  config.told = options.prior != "not-told";
  fs::create_directories(options.out);
  std::vector<study::WorldResult> results;
  {
    cli::Progress progress("psf study");
    study::run_study(config, [&](double share) { progress.show(share); }, [&](const study::WorldResult& result) {
      results.push_back(result);
      write_study(config, results, options.out);
    });
  }
  std::fputs(study::markdown_of(config, results).c_str(), stdout);
  return 0;
}

int run_graph(const Options& options) {
  bench::GraphTable table;
  {
    cli::Progress progress("graph");
    table = bench::measure_graph(options.graph, [&](double share) { progress.show(share); });
  }
  std::fputs((options.json ? bench::json_of(table) : bench::text_of(table)).c_str(), stdout);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  cli::Command campaign;
  cli::Command pose;
  cli::Command neighbours;
  cli::Command occupancy;
  cli::Command graph;
  cli::Command psf_study;
  return cli::run_program(
      argc, argv, "slamd-bench", "Measures slamd.",
      [&](const cli::Command& app) {
        app.require_command();
        campaign = app.command("campaign",
                                      "Maps simulated drives: worlds x sensors x seeds; goes on where it was stopped");
        campaign.option("SIZE", options.size, "quick: 12 x 60 s; full: 36 x 5 min")
            .required()
            .one_of({"quick", "full"});
        campaign.option("--out", options.out, "Directory for results.jsonl, table.txt, campaign.html").required();
        campaign.option("--set", options.overrides, "key=value of slamd's configuration").take_all();
        cli::Command rays = app.command("rays", "Speed of the simulator's ray casting on one core, by world");
        rays.option("--seed", options.seed, "Of the worlds").shows_default();
        pose = app.command("pose-latency",
                                  "From an inertial sample to the subscriber of its pose: quiet and beside hogs, SCHED_FIFO and SCHED_OTHER");
        pose.option("--seconds", options.pose.seconds, "Of each of the four rows").within(5.0, 3600.0).shows_default();
        pose.option("--imu-rate", options.pose.imu_rate_hz, "Hz").within(50.0, 1000.0).shows_default();
        pose.option("--pose-bytes", options.pose.pose_bytes, "Poses are padded to this size").within(0, 1400).shows_default();
        pose.option("--hogs", options.pose.hogs, "Programs that only compute").within(1, 64).shows_default();
        pose.flag("--json", options.json, "Print JSON");
        neighbours = app.command(
            "neighbours", "The map's neighbour search beside PCL's KdTreeFLANN and nanoflann: CPU time, ratios, recall");
        neighbours.option("--seed", options.seed, "Of the world").shows_default();
        neighbours.option("--scans", options.scans, "To take the median over")
            .within(1, 500)
            .shows_default();
        occupancy = app.command("occupancy", "The occupancy grid on a VLP-16's scans, by world: CPU time a scan, bytes a second");
        occupancy.option("--seed", options.seed, "Of the worlds").shows_default();
        occupancy.option("--scans", options.scans, "Of 0.1 s").within(2, 10'000).shows_default();
        graph = app.command(
            "graph", "The factor graph on synthetic drives: CPU time beside Ceres, and what becomes of true and false loops");
        graph.option("--keyframes", options.graph.keyframes, "One or more sizes to time")
            .within(300, 10'000)
            .shows_default();
        graph.option("--seed", options.graph.seed, "Of the first drive").shows_default();
        graph.option("--drives", options.graph.drives, "Of each campaign; 0: time only")
            .within(0, 1'000)
            .shows_default();
        graph.flag("--json", options.json, "Print JSON");
        psf_study = app.command(
            "psf-study", "The particle swarm filter beside EKFs, a plain particle filter and its literal form: wrong priors, bursts, a bad inertial sensor");
        psf_study.option("--out", options.out, "Directory for psf-study.md, .json and the charts").required();
        psf_study.option("--n", options.study.n, "Draws a cell").within(1, 100000).shows_default();
        psf_study.option("--seed", options.seed, "Of worlds and draws").shows_default();
        psf_study.option("--world", options.study.worlds, "One or more; default: all six")
            .one_of(simulate::world_names());
        psf_study.option("--estimator", options.study.estimators, "One or more; default: all")
            .one_of(study::estimator_names(study::Experiment::kRegistration));
        psf_study.option("--experiment", options.experiment, "registration, tracking or both")
            .one_of({"registration", "tracking", "both"})
            .shows_default();
        psf_study.option("--prior", options.prior, "What the filters are told of the errors: not-told, told or both")
            .one_of({"not-told", "told", "both"})
            .shows_default();
        psf_study.option("--set", options.study.overrides, "key=value of slamd's configuration").take_all();
        psf_study.option("--drives", options.study.drives, "A world, of successive seeds")
            .within(1, 100)
            .shows_default();
        psf_study.option("--seconds", options.study.drive_s, "Of each drive")
            .within(15.0, 300.0)
            .shows_default();
        psf_study.option("--threads", options.study.threads, "The result is the same for any number")
            .within(1, 64)
            .shows_default();
      },
      [&] {
        if (campaign.is_given()) {
          return run_campaign(options);
        }
        if (pose.is_given()) {
          return run_pose_latency(options);
        }
        if (occupancy.is_given()) {
          return run_occupancy(options);
        }
        if (graph.is_given()) {
          return run_graph(options);
        }
        if (psf_study.is_given()) {
          return run_psf_study(options);
        }
        return neighbours.is_given() ? run_neighbours(options) : run_rays(options);
      });
}
