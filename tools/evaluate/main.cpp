#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/cli/cli.hpp"
#include "tools/evaluate/evaluate.hpp"
#include "tools/evaluate/loops.hpp"

namespace {

using namespace slamd;

void declare(CLI::App& app, evaluate::Options& options) {
  app.add_option("REFERENCE", options.reference, "TUM file; or KITTI rows, with --times");
  app.add_option("ESTIMATE", options.estimate, "TUM file; or KITTI rows, with --times");
  app.add_option("--times", options.times, "Stamps of KITTI rows, s, one a line");
  app.add_option("--motions", options.motions, "motions.csv of the estimate: also tell whether its covariances can be believed");
  app.add_flag("--json", options.json, "Print JSON");
  app.add_flag("--evo", options.evo, "Associate nearest stamps by evo's rules (10 ms) instead of interpolating");
  app.add_option("--offset", options.offset_s, "Seconds to add to the estimate's stamps")->capture_default_str();
  app.add_option("--max-gap", options.max_gap_s, "Longest gap of the reference that is interpolated, s")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--n-to-align", options.align_count, "Align with the first N poses only; 0: all")->capture_default_str();
  app.add_option("--rpe-delta", options.rule.delta, "Distance of RPE's pairs")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--rpe-unit", options.unit, "Its unit")->check(CLI::IsMember({"frames", "m", "deg"}))->capture_default_str();
  app.add_flag("--all-pairs", options.rule.all_pairs, "RPE over all pairs, not consecutive ones");
  app.add_flag("--pairs-from-reference", options.rule.from_reference, "Choose RPE's pairs along the reference");
}

CLI::App* declare_loops(CLI::App& app, evaluate::LoopOptions& options) {
  CLI::App* const command = app.add_subcommand("loops", "Says how many of the true revisits a map has closed, and whether a loop is wrong");
  command->add_option("TRUTH", options.truth, "TUM file: base in world")->required();
  command->add_option("SESSION", options.session, "Folder of a session: DIR/session of slamd-replay, or of the daemon")->required();
  command->add_option("--near", options.near_m, "So near a place was passed before, m: 2 indoors")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--view", options.view_deg, "Between the headings, at most: 40 for an Avia, degrees")->check(CLI::Range(1.0, 180.0))->capture_default_str();
  command->add_option("--within", options.within_m, "A loop closes what lies so far before or behind it on the way, m")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_flag("--json", options.json, "Print JSON");
  return command;
}

void need(const std::string& given, const char* name) {
  if (given.empty()) {
    throw cli::UsageError(std::string(name) + " is required");
  }
}

}  // namespace

int main(int argc, char** argv) {
  evaluate::Options options;
  evaluate::LoopOptions loop_options;
  CLI::App* loops = nullptr;
  return cli::run_program(argc, argv, "slamd-evaluate", "Compares an estimated trajectory with a reference, or the loops of a map with the truth.",
                          [&](CLI::App& app) {
                            declare(app, options);
                            loops = declare_loops(app, loop_options);
                          },
                          [&] {
                            if (loops->parsed()) {
                              std::fputs(evaluate::evaluate_loops(loop_options).c_str(), stdout);
                              return 0;
                            }
                            need(options.reference, "REFERENCE");
                            need(options.estimate, "ESTIMATE");
                            std::fputs(evaluate::evaluate(options).c_str(), stdout);
                            return 0;
                          });
}
