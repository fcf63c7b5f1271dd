#include "tools/report/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "tools/plot/line_chart.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/point_picture.hpp"
#include "tools/plot/stacked_chart.hpp"
#include "tools/plot/timeline.hpp"
#include "tools/report/page.hpp"

namespace slamd::report {

namespace {

constexpr std::size_t kPictureWidth = 1300;  // pixels: sharp on a screen of 1.5 pixels per CSS px
constexpr const char* kTruthColour = "#b4bac2";  // a broad band below the others
constexpr const char* kRunColour = plot::kSeriesColours[0];
constexpr const char* kComparedColour = plot::kSeriesColours[1];
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double seconds_since_start(const FilterRun& run, Stamp stamp) {
  return to_seconds(stamp - run.scans.front().pose.stamp);
}

std::vector<Eigen::Vector3f> places(const FilterRun& run) {
  std::vector<Eigen::Vector3f> points;
  for (const ScanSample& scan : run.scans) {
    points.push_back(scan.pose.T.translation().cast<float>());
  }
  return points;
}

/// The horizontal direction along which the path, or else the map, is longest.
Eigen::Vector3f long_axis(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  const std::size_t step = std::max<std::size_t>(1, points.size() / 20'000);
  double count = 0.0;
  for (std::size_t i = 0; i < points.size(); i += step, ++count) {
    const Eigen::Vector2d p = points[i].head<2>().cast<double>();
    mean += p;
    spread += p * p.transpose();
  }
  if (count < 2.0) {
    return Eigen::Vector3f::UnitX();
  }
  mean /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread / count -
                                                              mean * mean.transpose());
  Eigen::Vector2d axis = solver.eigenvectors().col(1);
  // The sign of an eigenvector is anyone's guess; pictures of the same world should look alike.
  if (axis.x() + 1e-3 * axis.y() < 0.0) {
    axis = -axis;
  }
  return {static_cast<float>(axis.x()), static_cast<float>(axis.y()), 0.0F};
}

/// The poses that belong to the map as it is drawn.
const FilterRun& drawn_run(const ReportContent& content) { return content.map_run ? *content.map_run : content.run; }

/// The loops as lines of one series, with gaps between them.
plot::Series loop_series(const ReportContent& content, const plot::Camera& camera) {
  plot::Series series;
  series.name = "loops";
  series.colour = "#e7298a";
  for (const auto& [a, b] : content.loops) {
    for (const Eigen::Vector3f* p : {&a, &b}) {
      series.x.push_back(p->dot(camera.across));
      series.y.push_back(p->dot(camera.up));
    }
    series.x.push_back(series.x.back());
    series.y.push_back(kNaN);
  }
  return series;
}

plot::Series projected(const std::vector<Eigen::Vector3f>& path,
                       const plot::Camera& camera,
                       const std::string& name) {
  plot::Series series;
  series.name = name;
  series.colour = "#ff9d3c";
  for (const Eigen::Vector3f& p : path) {
    series.x.push_back(p.dot(camera.across));
    series.y.push_back(p.dot(camera.up));
  }
  return series;
}

std::string map_view(const Scene& scene,
                     const plot::Camera& camera,
                     plot::LineChart chart,
                     std::string caption) {
  const auto path = places(drawn_run(scene.content));
  const plot::Window window = plot::window_of(scene.content.map_points, path, camera);
  const plot::PointPicture picture =
      plot::picture_of(scene.content.map_points, camera, window, kPictureWidth);
  const std::string image = "data:image/png;base64," + plot::base64(plot::png_of(picture.image));
  chart.backdrop = plot::Backdrop{picture.across, picture.up, image};
  chart.equal_scale = true;
  chart.y_stretch = camera.stretch;
  chart.series = {projected(path, camera, "path of base")};
  if (!scene.content.loops.empty()) {
    chart.series.push_back(loop_series(scene.content, camera));
  }
  caption += " Colours: height, from " + number(picture.colour.low, 1) + " m (violet) to " +
             number(picture.colour.high, 1) + " m (yellow).";
  return figure(plot::svg_of(chart), caption, Shape::kWide);
}

plot::Series path_series(const evaluation::Trajectory& trajectory, const std::string& name) {
  plot::Series series;
  series.name = name;
  series.colour = kRunColour;
  for (const evaluation::TimedPose& pose : trajectory) {
    series.x.push_back(pose.T.translation().x());
    series.y.push_back(pose.T.translation().y());
  }
  return series;
}

plot::Series aligned_path(const Accuracy& accuracy, const std::string& name) {
  plot::Series series;
  series.name = name;
  series.colour = kRunColour;
  for (const evaluation::PosePair& pair : accuracy.pairs) {
    const Eigen::Vector3d p = accuracy.alignment.apply(pair.estimate).translation();
    series.x.push_back(p.x());
    series.y.push_back(p.y());
  }
  return series;
}

/// The truth while the run lasted, and a little around it.
plot::Series truth_series(const Accuracy& accuracy) {
  plot::Series series;
  series.name = "truth";
  series.colour = kTruthColour;
  series.broad = true;
  for (const evaluation::PosePair& pair : accuracy.pairs) {
    series.x.push_back(pair.reference.translation().x());
    series.y.push_back(pair.reference.translation().y());
  }
  return series;
}

/// The second filter's line: dashed, so that the first one shows through where both agree.
plot::Series compared(plot::Series series) {
  series.colour = kComparedColour;
  series.dashed = true;
  return series;
}

plot::Series error_series(const Accuracy& accuracy, Stamp begin, const std::string& name) {
  plot::Series series;
  series.name = name;
  series.y = evaluation::ape_translation_m(accuracy.pairs, accuracy.alignment);
  for (double& error : series.y) {
    error *= 100.0;
  }
  for (const evaluation::PosePair& pair : accuracy.pairs) {
    series.x.push_back(to_seconds(pair.stamp - begin));
  }
  return series;
}

std::string error_figure(const Scene& scene) {
  plot::LineChart chart;
  chart.alt = "Position error against truth over time";
  chart.x_label = "time [s]";
  chart.y_label = "position error [cm]";
  chart.from_zero = true;
  const Stamp begin = scene.content.run.scans.front().pose.stamp;
  chart.series.push_back(error_series(*scene.run, begin, scene.content.run.filter));
  if (scene.comparison) {
    chart.series.push_back(
        compared(error_series(*scene.comparison, begin, scene.content.comparison->filter)));
  }
  return figure(plot::svg_of(chart),
                scene.run->yaw_only
                    ? "Distance to the truth after alignment by yaw (the path is a straight line)."
                    : "Distance to the truth after alignment (SE(3)).");
}

std::string height_figure(const Scene& scene) {
  plot::LineChart chart;
  chart.alt = "Height of the path over time";
  chart.x_label = "time [s]";
  chart.y_label = "z [m]";
  const FilterRun& run = scene.content.run;
  plot::Series height{
      .name = run.filter, .x = {}, .y = {}, .colour = kRunColour, .dashed = false, .points = false};
  plot::Series truth{
      .name = "truth", .x = {}, .y = {}, .colour = kTruthColour, .dashed = false, .points = false};
  truth.broad = true;
  if (scene.run) {
    for (const evaluation::PosePair& pair : scene.run->pairs) {
      truth.x.push_back(seconds_since_start(run, pair.stamp));
      truth.y.push_back(pair.reference.translation().z());
      height.x.push_back(truth.x.back());
      height.y.push_back(scene.run->alignment.apply(pair.estimate).translation().z());
    }
    chart.series = {truth, height};
  } else {
    for (const ScanSample& scan : run.scans) {
      height.x.push_back(seconds_since_start(run, scan.pose.stamp));
      height.y.push_back(scan.pose.T.translation().z());
    }
    chart.series = {height};
  }
  return figure(plot::svg_of(chart), "Height of base over time.");
}

std::string stage_figure(const FilterRun& run) {
  plot::StackedChart chart;
  chart.alt = "Processor time per scan by stage, " + run.filter;
  chart.x_label = "time [s]";
  chart.y_label = "CPU time per scan [ms]";
  for (const ScanSample& scan : run.scans) {
    chart.x.push_back(seconds_since_start(run, scan.pose.stamp));
  }
  for (std::size_t k = 0; k < run.stages.size(); ++k) {
    plot::Layer layer{run.stages[k], {}};
    for (const ScanSample& scan : run.scans) {
      layer.y.push_back(k < scan.stage_ms.size() ? scan.stage_ms[k] : 0.0);
    }
    chart.layers.push_back(std::move(layer));
  }
  return figure(plot::svg_of(chart),
                "CPU time of each stage (" + run.filter + "), mean of neighbouring scans.");
}

std::string swarm_figure(const FilterRun& run) {
  plot::Series little{
      .name = "swarm", .x = {}, .y = {}, .colour = "", .dashed = false, .points = false};
  plot::Series won{.name = "swarm's mode taken",
                   .x = {},
                   .y = {},
                   .colour = "#d55e00",
                   .dashed = false,
                   .points = true};
  std::size_t recoveries = 0;
  std::uint32_t most = 0;
  for (const ScanSample& scan : run.scans) {
    little.x.push_back(seconds_since_start(run, scan.pose.stamp));
    little.y.push_back(scan.particles);
    won.x.push_back(little.x.back());
    won.y.push_back(scan.swarm_won ? scan.particles : kNaN);
    recoveries += scan.recovery_swarm ? 1 : 0;
    most = std::max(most, scan.particles);
  }
  if (most == 0) {
    return "";
  }
  const auto wins = std::count_if(
      run.scans.begin(), run.scans.end(), [](const auto& scan) { return scan.swarm_won; });
  plot::LineChart chart;
  chart.alt = "Number of particles over time";
  chart.x_label = "time [s]";
  chart.y_label = "particles";
  chart.from_zero = true;
  chart.series = {std::move(little)};
  if (wins > 0) {
    chart.series.push_back(std::move(won));
  }
  return figure(plot::svg_of(chart),
                "Swarm use: recovery swarm in " + std::to_string(recoveries) + " of " +
                    std::to_string(run.scans.size()) + " scans; a mode of the swarm replaced the " +
                    "plain update in " + std::to_string(wins) + ".");
}

plot::TimelineRow states_of(const FilterRun& run) {
  plot::TimelineRow row{run.filter, {}};
  const ScanSample* last = nullptr;
  for (const ScanSample& scan : run.scans) {
    const double t = seconds_since_start(run, scan.pose.stamp);
    if (last != nullptr) {
      row.spans.back().end = t;
    }
    if (last == nullptr || last->state != scan.state || last->cause != scan.cause) {
      row.spans.push_back(
          {t, t, scan.state, scan.state + (scan.cause.empty() ? "" : ": " + scan.cause)});
    }
    last = &scan;
  }
  return row;
}

std::string state_figure(const ReportContent& content) {
  plot::Timeline timeline;
  timeline.alt = "States over time";
  timeline.x_label = "time [s]";
  timeline.colours = {{"TRACKING", "#009e73"},
                      {"DEGRADED", "#e69f00"},
                      {"LOST", "#d55e00"},
                      {"RELOCALISING", "#cc79a7"},
                      {"STARTING", "#56b4e9"}};
  timeline.rows.push_back(states_of(content.run));
  if (content.comparison && !content.comparison->scans.empty()) {
    timeline.rows.push_back(states_of(*content.comparison));
  }
  return figure(plot::svg_of(timeline), "States over time; the table below names their causes.");
}

}  // namespace

std::string map_figures(const Scene& scene) {
  if (scene.content.map_points.empty()) {
    return "";
  }
  plot::LineChart top;
  top.alt = "Map seen from above, with the path";
  top.x_label = scene.content.map_run ? "x of map [m]" : "x of odom [m]";
  top.y_label = "y [m]";
  const std::string from_above = map_view(scene, {}, top, "The map from above.");

  plot::Camera camera;
  camera.across = long_axis(scene.content.map_points);
  camera.up = Eigen::Vector3f::UnitZ();
  const plot::Window window =
      plot::window_of(scene.content.map_points, places(drawn_run(scene.content)), camera);
  // A drive is much longer than houses are high.
  camera.stretch = std::clamp(std::ceil(0.25 * window.across.size() / window.up.size()), 1.0, 10.0);
  const auto heading_deg = static_cast<int>(
      std::lround(std::atan2(camera.across.y(), camera.across.x()) * 180.0 / M_PI));
  plot::LineChart side;
  side.alt = "Map seen from the side, with the path";
  side.x_label = "along the map, " + std::to_string(heading_deg) + "° from x [m]";
  side.y_label = camera.stretch > 1.0
                     ? "z [m], drawn " + number(camera.stretch, 0) + " times longer"
                     : "z [m]";
  return from_above + map_view(scene, camera, side, "The map from the side, along its length.");
}

std::string path_figures(const Scene& scene) {
  plot::LineChart chart;
  chart.equal_scale = true;
  chart.alt = "Path seen from above";
  chart.x_label = "x [m]";
  chart.y_label = "y [m]";
  const ReportContent& content = scene.content;
  if (scene.run) {
    chart.series = {truth_series(*scene.run), aligned_path(*scene.run, content.run.filter)};
    if (scene.comparison) {
      chart.series.push_back(compared(aligned_path(*scene.comparison, content.comparison->filter)));
    }
  } else {
    chart.series = {path_series(trajectory_of(content.run), content.run.filter)};
    if (content.comparison) {
      chart.series.push_back(
          compared(path_series(trajectory_of(*content.comparison), content.comparison->filter)));
    }
  }
  const char* caption =
      scene.run ? "Paths from above, laid on the truth." : "Path from above, in odom.";
  std::string html =
      figure(plot::svg_of(chart), caption, scene.run ? Shape::kTall : Shape::kCell);
  html += scene.run ? error_figure(scene) : "";
  return html + height_figure(scene);
}

std::string health_figures(const Scene& scene) {
  const ReportContent& content = scene.content;
  std::string html = state_figure(content) + swarm_figure(content.run) + stage_figure(content.run);
  if (content.comparison && !content.comparison->scans.empty()) {
    html += stage_figure(*content.comparison);
  }
  return html;
}

}  // namespace slamd::report
