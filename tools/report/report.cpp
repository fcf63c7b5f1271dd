#include "tools/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <stdexcept>

#include "tools/plot/svg.hpp"
#include "tools/report/accuracy.hpp"
#include "tools/report/page.hpp"
#include "tools/report/pictures.hpp"

namespace slamd::report {

namespace {

constexpr double kDegrees = 180.0 / M_PI;

/// A value of an ascending list: the smallest that `share` of the others do not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
  return sorted[std::min(at, sorted.size() - 1)];
}

std::vector<double> total_ms(const FilterRun& run) {
  std::vector<double> totals;
  for (const ScanSample& scan : run.scans) {
    totals.push_back(std::accumulate(scan.stage_ms.begin(), scan.stage_ms.end(), 0.0));
  }
  return totals;
}

std::vector<std::string> time_row(const std::string& name, std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  return {name,
          number(quantile(ms, 0.5), 2),
          number(quantile(ms, 0.95), 2),
          number(quantile(ms, 0.99), 2),
          number(ms.back(), 2)};
}

std::string times_table(const FilterRun& run) {
  HtmlTable table{{"CPU time [ms], " + run.filter, "median", "95 %", "99 %", "max"}, {}};
  for (std::size_t k = 0; k < run.stages.size(); ++k) {
    std::vector<double> ms;
    for (const ScanSample& scan : run.scans) {
      ms.push_back(k < scan.stage_ms.size() ? scan.stage_ms[k] : 0.0);
    }
    table.rows.push_back(time_row(run.stages[k], std::move(ms)));
  }
  table.rows.push_back(time_row("whole scan", total_ms(run)));
  return html_of(table);
}

/// How many scans were in a state for a cause.
std::string states_table(const FilterRun& run) {
  std::map<std::pair<std::string, std::string>, std::size_t> scans;
  for (const ScanSample& scan : run.scans) {
    ++scans[{scan.state, scan.cause}];
  }
  HtmlTable table{{"state, " + run.filter, "cause", "scans", "share"}, {}};
  for (const auto& [key, count] : scans) {
    const double share = 100.0 * static_cast<double>(count) / static_cast<double>(run.scans.size());
    table.rows.push_back({key.first,
                          key.second.empty() ? "–" : key.second,
                          std::to_string(count),
                          number(share, 1) + " %"});
  }
  return html_of(table);
}

std::string counters_tables(const std::vector<CounterGroup>& groups) {
  std::string html;
  for (const CounterGroup& group : groups) {
    HtmlTable table{{group.name, "count"}, {}};
    for (const auto& [name, count] : group.counters) {
      std::string words = name;
      std::replace(words.begin(), words.end(), '_', ' ');
      table.rows.push_back({std::move(words), std::to_string(count)});
    }
    html += html_of(table);
  }
  return html;
}

std::string facts_list(const std::vector<Fact>& facts) {
  std::string html = "<dl class=\"facts\">\n";
  for (const Fact& fact : facts) {
    html += "<div><dt>" + plot::escaped(fact.name) + "</dt><dd>" + plot::escaped(fact.value) +
            "</dd></div>\n";
  }
  return html + "</dl>\n";
}

std::vector<Fact> summary_of(const Scene& scene) {
  const FilterRun& run = scene.content.run;
  std::vector<Fact> facts = {{"filter", run.filter}, {"scans", std::to_string(run.scans.size())}};
  if (!run.scans.empty()) {
    const double path_m = evaluation::path_length_m(trajectory_of(run));
    facts.push_back(
        {"duration",
         number(to_seconds(run.scans.back().pose.stamp - run.scans.front().pose.stamp), 1) + " s"});
    facts.push_back({"path", number(path_m, 1) + " m"});
    std::vector<double> ms = total_ms(run);
    std::sort(ms.begin(), ms.end());
    facts.push_back({"CPU per scan, median", number(quantile(ms, 0.5), 1) + " ms"});
    facts.push_back({"CPU per scan, 99 %", number(quantile(ms, 0.99), 1) + " ms"});
  }
  if (scene.run) {
    facts.push_back({"APE rmse", number(100.0 * scene.run->ape_m.rmse, 1) + " cm"});
    facts.push_back({"end drift", number(100.0 * scene.run->end_drift_m, 1) + " cm"});
  }
  facts.insert(facts.end(), scene.content.facts.begin(), scene.content.facts.end());
  return facts;
}

/// One row an error, one column a filter.
std::string accuracy_table(const Scene& scene) {
  HtmlTable table{{"against truth", scene.content.run.filter}, {}};
  std::vector<const Accuracy*> columns = {&*scene.run};
  if (scene.comparison) {
    table.header.push_back(scene.content.comparison->filter);
    columns.push_back(&*scene.comparison);
  }
  if (scene.map) {
    table.header.emplace_back("map, after loops");
    columns.push_back(&*scene.map);
  }
  const auto row = [&](const std::string& name,
                       const std::function<std::string(const Accuracy&)>& cell) {
    table.rows.push_back({name});
    for (const Accuracy* accuracy : columns) {
      table.rows.back().push_back(cell(*accuracy));
    }
  };
  const auto cm = [](double m) {
    return number(100.0 * m, 2) + " cm";
  };
  if (!scene.run->yaw_only) {
    row("APE, aligned by SE(3): rmse", [&](const Accuracy& a) { return cm(a.ape_m.rmse); });
    row("APE, aligned by SE(3): max", [&](const Accuracy& a) { return cm(a.ape_m.max); });
  }
  row("APE, aligned by yaw: rmse", [&](const Accuracy& a) { return cm(a.ape_yaw_m.rmse); });
  row("APE, first pose on first: rmse", [&](const Accuracy& a) { return cm(a.ape_origin_m.rmse); });
  row("end drift", [&](const Accuracy& a) { return cm(a.end_drift_m); });
  row("end drift, share of the path", [](const Accuracy& a) {
    return a.true_path_m > 0.0 ? number(100.0 * a.end_drift_m / a.true_path_m, 3) + " %"
                               : std::string("–");
  });
  row("tilt: mean", [](const Accuracy& a) { return number(a.tilt_rad.mean * kDegrees, 3) + "°"; });
  row("tilt: max", [](const Accuracy& a) { return number(a.tilt_rad.max * kDegrees, 3) + "°"; });
  row("poses compared", [](const Accuracy& a) { return std::to_string(a.pairs.size()); });
  return html_of(table);
}

/// The state at the end, and what else a reader should know first.
std::string banner(const ReportContent& content) {
  const FilterRun& run = content.run;
  if (run.scans.empty()) {
    return "<div class=\"banner bad\"><strong>No scan was processed</strong></div>\n";
  }
  const auto tracking = std::count_if(
      run.scans.begin(), run.scans.end(), [](const auto& s) { return s.state == "TRACKING"; });
  const double share =
      100.0 * static_cast<double>(tracking) / static_cast<double>(run.scans.size());
  const ScanSample& last = run.scans.back();
  const char* level = last.state == "LOST"                       ? "bad"
                      : last.state != "TRACKING" || share < 90.0 ? "fair"
                                                                 : "good";
  std::string html = "<div class=\"banner " + std::string(level) + "\"><strong>" +
                     plot::escaped(last.state) + "</strong> at the end" +
                     (last.cause.empty() ? "" : " (" + plot::escaped(last.cause) + ")") +
                     "; tracking in " + number(share, 1) + " % of the scans.";
  if (!content.remarks.empty()) {
    html += "<ul>";
    for (const std::string& remark : content.remarks) {
      html += "<li>" + plot::escaped(remark) + "</li>";
    }
    html += "</ul>";
  }
  return html + "</div>\n";
}

std::string in_columns(const std::string& html) {
  return "<div class=\"tables\">" + html + "</div>\n";
}

std::string figures(const std::string& html) {
  return "<div class=\"figures\">\n" + html + "</div>\n";
}

std::string sections_of_run(const Scene& scene) {
  const ReportContent& content = scene.content;
  std::string body;
  if (scene.run) {
    body += section("Accuracy", accuracy_table(scene));
  }
  const std::string maps = map_figures(scene);
  if (!maps.empty()) {
    body += section("Map", figures(maps));
  }
  body += section("Path", figures(path_figures(scene)));
  std::string tables = states_table(content.run) + times_table(content.run);
  if (content.comparison && !content.comparison->scans.empty()) {
    tables += states_table(*content.comparison) + times_table(*content.comparison);
  }
  return body +
         section("States, swarm and time", figures(health_figures(scene)) + in_columns(tables));
}

}  // namespace

std::string html_of(const ReportContent& content) {
  Scene scene{content, accuracy_of(content.run, content.truth), std::nullopt, std::nullopt};
  if (content.comparison) {
    scene.comparison = accuracy_of(*content.comparison, content.truth);
  }
  if (content.map_run) {
    scene.map = accuracy_of(*content.map_run, content.truth);
  }
  std::string body = "<h1>" + plot::escaped(content.recording) +
                     "</h1>\n<p class=\"made\">slamd report, made with " +
                     plot::escaped(content.made_with) + "</p>\n" + banner(content) +
                     section("Summary", facts_list(summary_of(scene)));
  if (!content.run.scans.empty()) {
    body += sections_of_run(scene);
  }
  if (!content.counters.empty()) {
    body += section("What came in", in_columns(counters_tables(content.counters)));
  }
  if (!content.configuration.empty()) {
    body += "<section><details><summary>Configuration used</summary><pre>" +
            plot::escaped(content.configuration) + "</pre></details></section>\n";
  }
  return page(content.recording + ": slamd report", body);
}

void write_report(const std::filesystem::path& file, const ReportContent& content) {
  std::ofstream stream(file, std::ios::binary);
  stream << html_of(content);
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace slamd::report
