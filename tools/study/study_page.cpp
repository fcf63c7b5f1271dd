#include "tools/study/study_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "core/evaluation/median.hpp"
#include "tools/plot/line_chart.hpp"
#include "tools/plot/palette.hpp"
#include "tools/study/wilson_interval.hpp"

namespace slamd::study {

using nlohmann::ordered_json;

namespace {

/// The worlds under the open sky; a tunnel hides its own axis from everyone.
bool is_outdoors(const std::string& world) {
  return world == "town" || world == "campus" || world == "harbour";
}

const char* name_of(Experiment experiment) {
  return experiment == Experiment::kRegistration ? "registration" : "tracking";
}

std::string percent_interval(std::size_t hits, std::size_t n) {
  const Interval interval = wilson_interval(hits, n);
  char text[48];
  std::snprintf(text, sizeof text, "%.0f–%.0f", 100.0 * interval.low, 100.0 * interval.high);
  return text;
}

std::string cell_text(std::size_t hits, std::size_t n) {
  return n == 0 ? "–" : std::to_string(hits) + " (" + percent_interval(hits, n) + ")";
}

struct Counts {
  std::size_t n = 0;
  std::size_t hits = 0;
  std::vector<double> medians_m;

  void add(const Cell& cell) {
    n += cell.n;
    hits += cell.hits;
    if (std::isfinite(cell.median_error_m)) {
      medians_m.push_back(cell.median_error_m);
    }
  }
};

/// Sums the cells of all worlds that `wanted(world)` wants.
template <typename Wanted>
Counts sum_of(const std::vector<WorldResult>& results, const CellKey& key, Wanted&& wanted) {
  Counts sum;
  for (const WorldResult& result : results) {
    for (const Cell& cell : result.cells) {
      if (wanted(result.world) && cell.key.experiment == key.experiment &&
          cell.key.condition == key.condition && cell.key.told == key.told &&
          cell.key.estimator == key.estimator) {
        sum.add(cell);
      }
    }
  }
  return sum;
}

template <typename Wanted>
std::string row_of(const std::string& title,
                   const std::vector<WorldResult>& results,
                   CellKey key,
                   Wanted&& wanted) {
  std::string row = "| " + title + " | " + key.condition + " |";
  std::size_t n = 0;
  for (const std::string& estimator : estimator_names(key.experiment)) {
    key.estimator = estimator;
    const Counts sum = sum_of(results, key, wanted);
    n = std::max(n, sum.n);
    row += " " + cell_text(sum.hits, sum.n) + " |";
  }
  return n == 0 ? "" : row + " " + std::to_string(n) + " |\n";
}

std::string table_of(Experiment experiment, bool told, const std::vector<WorldResult>& results) {
  std::string text = "| world | error |";
  std::string rule = "|---|---|";
  for (const std::string& estimator : estimator_names(experiment)) {
    text += " " + estimator + " |";
    rule += "---|";
  }
  text += " n |\n" + rule + "---|\n";
  for (const WorldResult& result : results) {
    for (const std::string& condition : conditions(experiment)) {
      text += row_of(
          result.world, results, {experiment, condition, told, ""}, [&](const std::string& world) {
            return world == result.world;
          });
    }
  }
  for (const std::string& condition : conditions(experiment)) {
    text += row_of("**outdoors**", results, {experiment, condition, told, ""}, is_outdoors);
  }
  for (const std::string& condition : conditions(experiment)) {
    text += row_of("**all**", results, {experiment, condition, told, ""}, [](const std::string&) {
      return true;
    });
  }
  return text;
}

/// The same in both charts.
std::string colour_of(const std::string& estimator) {
  const std::vector<std::string>& all = estimator_names(Experiment::kRegistration);
  const auto place =
      static_cast<std::size_t>(std::find(all.begin(), all.end(), estimator) - all.begin());
  return plot::kSeriesColours[(place + 1) % plot::kSeriesColours.size()];  // the last, slamd's own,
                                                                           // in the first colour
}

/// Median end errors of what did not fail, over the worlds' medians.
std::string error_table(const StudyConfig& config, const std::vector<WorldResult>& results) {
  std::string text = "| median end error, cm |";
  std::string rule = "|---|";
  for (const std::string& estimator : estimator_names(Experiment::kTracking)) {
    text += " " + estimator + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const bool told : {false, true}) {
    if (!config.has(Experiment::kTracking, told)) {
      continue;
    }
    for (const std::string& condition : conditions(Experiment::kTracking)) {
      text += "| " + condition + (told ? ", told |" : ", not told |");
      for (const std::string& estimator : estimator_names(Experiment::kTracking)) {
        const Counts sum = sum_of(results,
                            {Experiment::kTracking, condition, told, estimator},
                            [](const std::string&) { return true; });
        char cell[32];
        std::snprintf(
            cell,
            sizeof cell,
            sum.medians_m.empty() ? " – |" : " %.1f |",
            sum.medians_m.empty() ? 0.0 : 100.0 * evaluation::median_of(sum.medians_m));
        text += cell;
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace

std::string markdown_of(const StudyConfig& config, const std::vector<WorldResult>& results) {
  char text[512];
  std::snprintf(text,
                sizeof text,
                "VLP-16 and inertial sensor, %zu drives of %.0f s a world, seed %llu. In brackets: "
                "95 %% intervals, per cent.\n",
                config.drives,
                config.drive_s,
                static_cast<unsigned long long>(config.seed));
  std::string page = text;
  page += "\nReference against truth, worst APE rmse of a world's drives:";
  for (const WorldResult& result : results) {
    std::snprintf(text, sizeof text, " %s %.3f m", result.world.c_str(), result.reference_ape_m);
    page += text;
    page += &result == &results.back() ? ".\n" : ",";
  }
  std::snprintf(text,
                sizeof text,
                "\nRegistration: successes, i.e. within %.2f m and %.0f° of the reference. Prior ",
                kSuccess_m,
                kSuccess_deg);
  const std::string registration = text;
  std::snprintf(text,
                sizeof text,
                "\nTracking: lost runs of %zu scans, i.e. farther than %.1f m or %.0f° from the "
                "reference in %zu scans in a row or "
                "at the end; an error every %zu scans. Prior ",
                kRunScans,
                kLost_m,
                kLost_deg,
                kBurstEvery,
                kBurstEvery);
  const std::string tracking = text;
  for (const Experiment experiment : {Experiment::kRegistration, Experiment::kTracking}) {
    for (const bool told : {false, true}) {
      if (config.has(experiment, told)) {
        page += experiment == Experiment::kRegistration ? registration : tracking;
        page += (told ? "told.\n\n" : "not told.\n\n") + table_of(experiment, told, results);
      }
    }
  }
  if (config.tracking) {
    page += "\nTracking, of the runs that were not lost (median of the worlds' medians).\n\n" +
            error_table(config, results);
  }
  return page;
}

std::string json_of(const StudyConfig& config, const std::vector<WorldResult>& results) {
  ordered_json json = {{"n", config.n},
                       {"seed", config.seed},
                       {"drives", config.drives},
                       {"drive_s", config.drive_s},
                       {"success_m", kSuccess_m},
                       {"success_deg", kSuccess_deg},
                       {"lost_m", kLost_m},
                       {"lost_deg", kLost_deg},
                       {"run_scans", kRunScans},
                       {"burst_every", kBurstEvery},
                       {"worlds", ordered_json::array()}};
  for (const WorldResult& result : results) {
    ordered_json world = {{"world", result.world},
                          {"reference_ape_m", result.reference_ape_m},
                          {"cells", ordered_json::array()}};
    for (const Cell& cell : result.cells) {
      const Interval interval = wilson_interval(cell.hits, cell.n);
      world["cells"].push_back(
          {{"experiment", name_of(cell.key.experiment)},
           {"condition", cell.key.condition},
           {"told", cell.key.told},
           {"estimator", cell.key.estimator},
           {"n", cell.n},
           {cell.key.experiment == Experiment::kRegistration ? "successes" : "lost", cell.hits},
           {"low", interval.low},
           {"high", interval.high},
           {"median_error_m", cell.median_error_m}});
    }
    json["worlds"].push_back(std::move(world));
  }
  return json.dump(1) + "\n";
}

std::string svg_of(Experiment experiment, const std::vector<WorldResult>& results) {
  const bool registration = experiment == Experiment::kRegistration;
  plot::LineChart chart;
  chart.alt = registration
                  ? "Share of successful registrations over the size of the prior's error, by "
                    "estimator; told dashed"
                  : "Share of lost runs over the size of the bursts, by estimator; told dashed";
  chart.x_label = "error up to [m], and with it 10° a metre, 20° at 1.5 m";
  chart.y_label = registration ? "successes [%]" : "lost runs [%]";
  chart.from_zero = true;
  for (const bool told : {false, true}) {
    for (const std::string& estimator : estimator_names(experiment)) {
      plot::Series series;
      series.name = told ? "" : estimator;
      series.colour = colour_of(estimator);
      series.dashed = told;
      for (const std::string& condition : conditions(experiment)) {
        double size_m = 0.0;
        const Counts sum = sum_of(results,
                                  {experiment, condition, told, estimator},
                                  [](const std::string&) { return true; });
        if (std::sscanf(condition.c_str(), "%lf m", &size_m) == 1 && sum.n > 0) {
          series.x.push_back(size_m);
          series.y.push_back(100.0 * static_cast<double>(sum.hits) / static_cast<double>(sum.n));
        }
      }
      if (!series.x.empty()) {
        chart.series.push_back(std::move(series));
      }
    }
  }
  return plot::svg_of(chart);
}

}  // namespace slamd::study
