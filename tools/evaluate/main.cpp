#include <cstdio>
#include <string>

#include "tools/cli/cli.hpp"
#include "tools/evaluate/evaluate.hpp"

namespace {

using namespace slamd;

void declare(const cli::Command& app, evaluate::Options& options) {
  app.option("REFERENCE", options.reference, "TUM file; or KITTI rows, with --times").required();
  app.option("ESTIMATE", options.estimate, "TUM file; or KITTI rows, with --times").required();
  app.option("--times", options.times, "Stamps of KITTI rows, s, one a line");
  app.option("--motions", options.motions, "motions.csv of the estimate: also tell whether its covariances can be believed");
  app.flag("--json", options.json, "Print JSON");
  app.flag("--evo", options.evo, "Associate nearest stamps by evo's rules (10 ms) instead of interpolating");
  app.option("--offset", options.offset_s, "Seconds to add to the estimate's stamps").shows_default();
  app.option("--max-gap", options.max_gap_s, "Longest gap of the reference that is interpolated, s").positive().shows_default();
  app.option("--n-to-align", options.align_count, "Align with the first N poses only; 0: all").shows_default();
  app.option("--rpe-delta", options.rule.delta, "Distance of RPE's pairs").positive().shows_default();
  app.option("--rpe-unit", options.unit, "Its unit").one_of({"frames", "m", "deg"}).shows_default();
  app.flag("--all-pairs", options.rule.all_pairs, "RPE over all pairs, not consecutive ones");
  app.flag("--pairs-from-reference", options.rule.from_reference, "Choose RPE's pairs along the reference");
}

}  // namespace

int main(int argc, char** argv) {
  evaluate::Options options;
  return cli::run_program(argc, argv, "slamd-evaluate", "Compares an estimated trajectory with a reference.",
                          [&](const cli::Command& app) { declare(app, options); },
                          [&] {
                            std::fputs(evaluate::evaluate(options).c_str(), stdout);
                            return 0;
                          });
}
