#include "tools/bench/campaign_page.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/evaluation/median.hpp"
#include "tools/plot/line_chart.hpp"
#include "tools/plot/svg.hpp"

namespace slamd::bench {

namespace {

double percent_of_path(const Outcome& o) { return o.path_m > 0.0 ? 100.0 * o.end_drift_m / o.path_m : 0.0; }

template <typename Get>
double median_over(const std::vector<const Outcome*>& outcomes, Get&& get) {
  std::vector<double> values;
  for (const Outcome* outcome : outcomes) {
    values.push_back(get(*outcome));
  }
  return evaluation::median_of(std::move(values));
}

std::vector<std::string> distinct(const std::vector<Outcome>& outcomes, std::string Outcome::*member) {
  std::vector<std::string> names;
  for (const Outcome& o : outcomes) {
    if (std::find(names.begin(), names.end(), o.*member) == names.end()) {
      names.push_back(o.*member);
    }
  }
  return names;
}

plot::LineChart errors_chart(const std::string& world, const std::vector<Outcome>& outcomes) {
  plot::LineChart chart;
  chart.alt = "Position error over time in the world " + world;
  chart.x_label = "time [s]";
  chart.y_label = "position error [m]";
  chart.from_zero = true;
  for (const Outcome& o : outcomes) {
    if (o.world != world) {
      continue;
    }
    plot::Series series;
    series.name = o.lidar + ", seed " + std::to_string(o.seed);
    for (std::size_t i = 0; i < o.error_m.size(); ++i) {
      series.x.push_back(static_cast<double>(i));
      series.y.push_back(o.error_m[i]);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

std::string table_of(const std::vector<Outcome>& outcomes) {
  char line[240];
  std::snprintf(line, sizeof line, "%-10s %-11s %4s %7s %7s %9s %9s %9s %8s %8s %6s %9s %7s\n", "world", "lidar",
                "seed", "path m", "scans", "tracking", "APE m", "APE max", "drift m", "drift %", "tilt", "ms/scan",
                "p99");
  std::string text = line;
  for (const Outcome& o : outcomes) {
    std::snprintf(
        line, sizeof line, "%-10s %-11s %4llu %7.1f %7llu %8.1f%% %9.4f %9.4f %8.4f %8.4f %6.3f %9.2f %7.2f\n",
        o.world.c_str(), o.lidar.c_str(), static_cast<unsigned long long>(o.seed), o.path_m,
        static_cast<unsigned long long>(o.scans),
        o.scans > 0 ? 100.0 * static_cast<double>(o.scans_tracking) / static_cast<double>(o.scans) : 0.0, o.ape_rmse_m,
        o.ape_max_m, o.end_drift_m, percent_of_path(o), o.tilt_mean_deg, o.cpu_median_ms, o.cpu_p99_ms);
    text += line;
  }
  for (const std::string& lidar : distinct(outcomes, &Outcome::lidar)) {
    std::vector<const Outcome*> of_lidar;
    for (const Outcome& o : outcomes) {
      if (o.lidar == lidar) {
        of_lidar.push_back(&o);
      }
    }
    std::snprintf(
        line, sizeof line, "%-10s %-11s %4s %7s %7s %9s %9.4f %9.4f %8.4f %8.4f %6.3f %9.2f %7.2f\n", "median",
        lidar.c_str(), "", "", "", "", median_over(of_lidar, [](const Outcome& o) { return o.ape_rmse_m; }),
        median_over(of_lidar, [](const Outcome& o) { return o.ape_max_m; }),
        median_over(of_lidar, [](const Outcome& o) { return o.end_drift_m; }), median_over(of_lidar, percent_of_path),
        median_over(of_lidar, [](const Outcome& o) { return o.tilt_mean_deg; }),
        median_over(of_lidar, [](const Outcome& o) { return o.cpu_median_ms; }),
        median_over(of_lidar, [](const Outcome& o) { return o.cpu_p99_ms; }));
    text += line;
  }
  return text;
}

std::string page_of(const std::string& campaign, const std::vector<Outcome>& outcomes) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>slamd-bench campaign " +
                     plot::escaped(campaign) +
                     "</title>\n<style>body{font:15px/1.5 sans-serif;max-width:75rem;margin:2rem auto;padding:0 "
                     "1rem}pre{overflow-x:auto;font-size:12px}"
                     ".charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(30rem,1fr));gap:1rem}svg{max-"
                     "width:100%;height:auto}</style></head><body>\n<h1>Campaign " +
                     plot::escaped(campaign) +
                     "</h1>\n<p>Simulated drives through slamd's stages, against their exact truth. APE is "
                     "SE(3)-aligned (by yaw where the path is straight), tilt is in degrees; drift is that of the "
                     "displacement from the first to the last pose.</p>\n<pre>" +
                     plot::escaped(table_of(outcomes)) + "</pre>\n<div class=\"charts\">\n";
  for (const std::string& world : distinct(outcomes, &Outcome::world)) {
    page += "<section><h2>" + plot::escaped(world) + "</h2>\n" + plot::svg_of(errors_chart(world, outcomes)) +
            "</section>\n";
  }
  return page + "</div>\n</body></html>\n";
}

}  // namespace slamd::bench
