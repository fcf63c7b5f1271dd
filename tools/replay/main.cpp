#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/evaluation/errors.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/replay/output.hpp"
#include "tools/replay/recording.hpp"
#include "tools/replay/replay.hpp"

int main(int argc, char** argv) {
  using namespace slamd;
  CLI::App app("replay");
  std::string out, rec;
  std::vector<std::string> configs, sets;
  app.add_option("--out", out)->required();
  app.add_option("--config", configs);
  app.add_option("--set", sets);
  app.add_option("RECORDING", rec)->required();
  CLI11_PARSE(app, argc, argv);
  try {
    auto r = replay::open_recording(rec, configs, sets);
    std::filesystem::create_directories(out);
    replay::ProductWriter w(out, r.configuration.output.map_spacing_m);
    auto run = replay::replay(r, {[&](const replay::ScanRecord& a, const scan::DeskewedScan& b) {
                                    w.add(a, b);
                                    if (getenv("DBG")) {
                                      const auto& u = a.odometry.update;
                                      std::fprintf(stderr, "%lu n=%zu inl %.2f match %.2f res %.4f it %d innov %.1f ll %.2f rec %d won %d state %d cause %d weak %d\n", static_cast<unsigned long>(a.odometry.scan_index), u.constraints, u.inlier_ratio, u.matched_ratio, u.mean_residual_m, u.iterations, u.innovation, a.odometry.swarm.plain_log_likelihood, a.odometry.swarm.recovery, a.odometry.swarm.swarm_won, int(a.odometry.state), int(a.odometry.cause), a.odometry.weak_axes);
                                    }
                                  }, {}});
    w.close();
    std::string acc;
    if (!r.truth.empty()) {
      evaluation::Trajectory ref;
      for (auto& p : recording::read_tum(r.truth)) ref.push_back({p.stamp, p.T});
      auto pairs = evaluation::associate_interpolated(ref, replay::trajectory_of(run), std::chrono::seconds(1));
      auto ape = evaluation::statistics_of(evaluation::ape_translation_m(pairs, evaluation::align(pairs, evaluation::Alignment::kSe3)));
      auto yaw = evaluation::statistics_of(evaluation::ape_translation_m(pairs, evaluation::align(pairs, evaluation::Alignment::kYaw)));
      double drift = evaluation::end_drift_m(pairs, evaluation::align(pairs, evaluation::Alignment::kSe3));
      char b[200];
      snprintf(b, 200, "{\"ape\":%.4f,\"yaw_ape\":%.4f,\"end\":%.4f,\"end_pct\":%.4f}", ape.rmse, yaw.rmse, drift, 100 * drift / replay::path_m(run));
      acc = b;
    }
    std::ofstream(std::filesystem::path(out) / "report.json") << replay::report_json(r, run, acc);
  } catch (const configuration::ConfigurationError& e) {
    std::fprintf(stderr, "slamd-replay: %s\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "slamd-replay: %s\n", e.what());
    return 1;
  }
}
