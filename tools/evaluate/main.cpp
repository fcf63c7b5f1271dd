#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/cli/cli.hpp"
#include "tools/evaluate/evaluate.hpp"

namespace {

using namespace slamd;

void declare(CLI::App& app, evaluate::Options& options) {
  app.add_option("REFERENCE", options.reference, "TUM file; or KITTI rows, with --times")->required();
  app.add_option("ESTIMATE", options.estimate, "TUM file; or KITTI rows, with --times")->required();
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

}  // namespace

int main(int argc, char** argv) {
  evaluate::Options options;
  return cli::run_program(argc, argv, "slamd-evaluate", "Compares an estimated trajectory with a reference.",
                          [&](CLI::App& app) { declare(app, options); },
                          [&] {
                            std::fputs(evaluate::evaluate(options).c_str(), stdout);
                            return 0;
                          });
}
