#include "tools/study/psf_study.hpp"

#include <gtest/gtest.h>

#include "tools/study/study_page.hpp"

namespace slamd::study {
namespace {

std::vector<WorldResult> run(StudyConfig& config, int threads) {
  config.threads = threads;
  std::vector<WorldResult> results;
  run_study(
      config,
      [](double share) { EXPECT_LE(share, 1.0); },
      [&](const WorldResult& result) { results.push_back(result); });
  return results;
}

TEST(PsfStudy, FillsEveryCellAndIsTheSameForAnyNumberOfThreads) {
  StudyConfig sut{.n = 2, .seed = 3, .drives = 2, .drive_s = 9.0, .worlds = {"warehouse"}};
  sut.tracking = false;

  const std::vector<WorldResult> one = run(sut, 1);
  const std::vector<WorldResult> two = run(sut, 2);

  ASSERT_EQ(one.size(), 1U);
  EXPECT_LT(one[0].reference_ape_m, 0.05);
  EXPECT_EQ(one[0].cells.size(), 2U * 4U * 6U);
  for (const Cell& cell : one[0].cells) {
    EXPECT_EQ(cell.n, 2U);
    EXPECT_LE(cell.hits, 2U);
  }
  EXPECT_EQ(json_of(sut, one), json_of(sut, two));
}

TEST(PsfStudy, PutsEveryEstimatorIntoTablesAndCharts) {
  StudyConfig sut{.n = 1, .drives = 1, .drive_s = 9.0, .worlds = {"town"}};
  sut.told = false;

  const std::vector<WorldResult> results = run(sut, 1);

  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].cells.size(), 4U * 6U + 4U * 5U);
  const std::string page = markdown_of(sut, results);
  for (const Experiment experiment : {Experiment::kRegistration, Experiment::kTracking}) {
    const std::string chart = svg_of(experiment, results);
    for (const std::string& estimator : estimator_names(experiment)) {
      EXPECT_NE(page.find("| " + estimator + " |"), std::string::npos) << estimator;
      EXPECT_NE(chart.find(">" + estimator + "<"), std::string::npos) << estimator;
    }
    for (const std::string& condition : conditions(experiment)) {
      EXPECT_NE(page.find("| town | " + condition + " |"), std::string::npos) << condition;
    }
  }
}

}  // namespace
}  // namespace slamd::study
