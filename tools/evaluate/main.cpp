#include <cstdio>
#include <string>

#include "tools/cli/cli.hpp"
#include "tools/evaluate/evaluate.hpp"
#include "tools/evaluate/loops.hpp"

namespace {

using namespace slamd;

void declare(const cli::Command& app, evaluate::Options& options) {
  app.option("REFERENCE", options.reference, "TUM file; or KITTI rows, with --times");
  app.option("ESTIMATE", options.estimate, "TUM file; or KITTI rows, with --times");
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

cli::Command declare_loops(const cli::Command& app, evaluate::LoopOptions& options) {
  const cli::Command command = app.command("loops", "Says how many of the true revisits a map has closed, and whether a loop is wrong");
  command.option("TRUTH", options.truth, "TUM file: base in world").required();
  command.option("SESSION", options.session, "Folder of a session: DIR/session of slamd-replay, or of the daemon").required();
  command.option("--near", options.near_m, "So near a place was passed before, m: 2 indoors").positive().shows_default();
  command.option("--view", options.view_deg, "Between the headings, at most: 40 for an Avia, degrees").within(1.0, 180.0).shows_default();
  command.option("--within", options.within_m, "A loop closes what lies so far before or behind it on the way, m").positive().shows_default();
  command.flag("--json", options.json, "Print JSON");
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
  cli::Command loops;
  return cli::run_program(argc, argv, "slamd-evaluate", "Compares an estimated trajectory with a reference, or the loops of a map with the truth.",
                          [&](const cli::Command& app) {
                            declare(app, options);
                            loops = declare_loops(app, loop_options);
                          },
                          [&] {
                            if (loops.is_given()) {
                              std::fputs(evaluate::evaluate_loops(loop_options).c_str(), stdout);
                              return 0;
                            }
                            need(options.reference, "REFERENCE");
                            need(options.estimate, "ESTIMATE");
                            std::fputs(evaluate::evaluate(options).c_str(), stdout);
                            return 0;
                          });
}
