#include "tools/report/report.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "drive.hpp"
#include "tools/report/accuracy.hpp"

namespace slamd::report {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++n;
  }
  return n;
}

TEST(HtmlOf, HoldsAllThatItShowsItself) {
  std::string html = html_of(drive_around_the_block());

  EXPECT_FALSE(contains(html, "<script"));
  EXPECT_FALSE(contains(html, "<link"));
  EXPECT_FALSE(contains(html, "url("));
  EXPECT_FALSE(contains(html, "src="));
  EXPECT_EQ(count(html, "http"), count(html, "xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_EQ(count(html, "href=\""), count(html, "href=\"data:image/png;base64,"));
}

TEST(HtmlOf, ShowsEveryPictureWithWordsForThoseWhoCannotSeeIt) {
  const std::string html = html_of(drive_around_the_block());

  for (const char* alt : {"Map seen from above",
                          "Map seen from the side",
                          "Path seen from above",
                          "Position error against truth over time",
                          "States over time",
                          "Number of particles over time",
                          "Processor time per scan by stage, psf",
                          "Processor time per scan by stage, iekf"}) {
    EXPECT_TRUE(contains(html, std::string("aria-label=\"") + alt)) << alt;
  }
}

TEST(HtmlOf, LetsTheFirstFilterShowThroughTheSecond) {
  const std::string html = html_of(drive_around_the_block());

  // Dashed are the second filter's path and its error, each with its mark in a legend.
  EXPECT_EQ(count(html, "stroke-dasharray=\"6 4\""), 4U);
}

TEST(HtmlOf, NamesStatesCausesAndRefusals) {
  const std::string html = html_of(drive_around_the_block());

  EXPECT_TRUE(contains(html, "DEGRADED: a direction that the scan does not see"));
  EXPECT_TRUE(contains(html, "<td>refused: foreign</td><td>17</td>"));
  EXPECT_TRUE(contains(
      html,
      "recovery swarm in 6 of 600 scans; a mode of the swarm replaced the plain update in 1."));
  EXPECT_TRUE(contains(html, "The device clock ran 12 ppm fast."));
}

TEST(HtmlOf, EscapesWhatOthersWrote) {
  ReportContent content = drive_around_the_block();
  content.recording = "<b>x</b>";
  content.configuration = "a = \"<&>\"";
  content.run.scans.back().cause = "<i>";

  const std::string html = html_of(content);

  EXPECT_FALSE(contains(html, "<b>x"));
  EXPECT_FALSE(contains(html, "<i>"));
  EXPECT_TRUE(contains(html, "a = &quot;&lt;&amp;&gt;&quot;"));
}

TEST(HtmlOf, DoesWithoutTruthMapSwarmAndComparison) {
  ReportContent content = drive_around_the_block();
  content.truth.clear();
  content.map_points.clear();
  content.comparison.reset();
  for (ScanSample& scan : content.run.scans) {
    scan.particles = 0;
  }

  const std::string html = html_of(content);

  EXPECT_FALSE(contains(html, "<h2>Accuracy</h2>"));
  EXPECT_FALSE(contains(html, "<h2>Map</h2>"));
  EXPECT_FALSE(contains(html, "Number of particles"));
  EXPECT_TRUE(contains(html, "Path from above, in odom."));
}

TEST(HtmlOf, SaysSoWhenNoScanWasProcessed) {
  const std::string html = html_of(ReportContent{});

  EXPECT_TRUE(contains(html, "No scan was processed"));
  EXPECT_FALSE(contains(html, "nan"));
}

TEST(HtmlOf, DrawsARunOfOneScan) {
  ReportContent content = drive_around_the_block();
  content.run.scans.resize(1);
  content.comparison.reset();
  content.map_points.clear();  // its picture's letters could spell anything

  const std::string html = html_of(content);

  EXPECT_FALSE(contains(html, "nan"));
  EXPECT_FALSE(contains(html, "inf"));
}

TEST(AccuracyOf, FallsBackToYawOnAStraightLine) {
  FilterRun run;
  evaluation::Trajectory truth;
  for (int i = 0; i < 10; ++i) {
    const Stamp stamp = Stamp{} + std::chrono::seconds(i);
    truth.push_back({stamp, {Eigen::Matrix3d::Identity(), {1.0 * i, 0.0, 0.0}}});
    ScanSample scan;
    scan.pose = {stamp, {Eigen::Matrix3d::Identity(), {0.0, 1.0 * i, 0.0}}};
    run.scans.push_back(scan);
  }

  const auto accuracy = accuracy_of(run, truth);

  ASSERT_TRUE(accuracy.has_value());
  EXPECT_TRUE(accuracy->yaw_only);
  EXPECT_NEAR(accuracy->ape_m.rmse, 0.0, 1e-12);
}

TEST(AccuracyOf, NeedsThreePosesInCommon) {
  const FilterRun run = drive_around_the_block().run;

  EXPECT_FALSE(accuracy_of(run, {}).has_value());
}

TEST(WriteReport, WritesTheDocument) {
  const std::filesystem::path file = std::filesystem::path(SLAMD_BINARY_DIR) / "tests/report.html";
  const ReportContent content = drive_around_the_block();

  write_report(file, content);

  std::ifstream stream(file, std::ios::binary);
  const std::string written{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_EQ(written, html_of(content));
  EXPECT_LT(written.size(), 3'000'000U);
}

TEST(WriteReport, NamesTheFileThatCannotBeWritten) {
  try {
    write_report("/proc/no/report.html", ReportContent{});
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(contains(error.what(), "/proc/no/report.html"));
  }
}

}  // namespace
}  // namespace slamd::report
