#include "tools/bench/campaign.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tools/bench/campaign_page.hpp"
#include "tools/bench/ray_speed.hpp"

namespace slamd::bench {
namespace {

class CampaignRun : public testing::Test {
 protected:
  CampaignRun() : folder_(std::filesystem::path(testing::TempDir()) / "slamd_bench_campaign") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    for (const char* world : {"town", "warehouse"}) {
      simulate::Drive drive;
      drive.world = world;
      drive.duration_s = 8.0;
      small_.drives.push_back(drive);
    }
  }

  ~CampaignRun() override { std::filesystem::remove_all(folder_); }

  std::string results() const {
    std::ifstream stream(folder_ / "results.jsonl");
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  std::vector<Outcome> run() {
    calls_ = 0;
    return run_campaign(small_, folder_, {}, [&](double share) {
      EXPECT_GE(share, 0.0);
      EXPECT_LE(share, 1.0);
      ++calls_;
    });
  }

  std::filesystem::path folder_;
  Campaign small_{"small", {}};
  int calls_ = 0;
};

TEST_F(CampaignRun, MeasuresEachDriveAgainstItsTruth) {
  const std::vector<Outcome> sut = run();

  ASSERT_EQ(sut.size(), 2U);
  for (const Outcome& outcome : sut) {
    EXPECT_GT(outcome.scans, 50U);
    EXPECT_GT(outcome.path_m, 1.0);
    EXPECT_GT(outcome.ape_rmse_m, 0.0);
    EXPECT_LT(outcome.ape_rmse_m, 0.1) << outcome.key;
    EXPECT_GT(outcome.cpu_median_ms, 0.0);
    EXPECT_GE(outcome.error_m.size(), 5U);
  }
  EXPECT_EQ(sut[0].world, "town");
  EXPECT_EQ(sut[1].world, "warehouse");
}

TEST_F(CampaignRun, GoesOnWhereItWasStopped) {
  const std::vector<Outcome> first = run();
  const std::string complete = results();
  // As if the power had failed within the second line.
  std::ofstream(folder_ / "results.jsonl") << complete.substr(0, complete.find('\n') + 30) << '\n';

  const std::vector<Outcome> second = run();
  const int calls_of_one = calls_;
  const std::vector<Outcome> third = run();

  EXPECT_GT(calls_of_one, 0);
  EXPECT_EQ(calls_, 0);
  ASSERT_EQ(third.size(), 2U);
  EXPECT_EQ(second[0].wall_s, first[0].wall_s);  // not run again
  EXPECT_EQ(second[1].ape_rmse_m, first[1].ape_rmse_m);
  EXPECT_EQ(third[1].wall_s, second[1].wall_s);
}

TEST_F(CampaignRun, ShowsARowForEachDriveAndAChartForEachWorld) {
  const std::vector<Outcome> outcomes = run();

  const std::string table = table_of(outcomes);
  const std::string page = page_of("small", outcomes);

  EXPECT_NE(table.find("\ntown "), std::string::npos);
  EXPECT_NE(table.find("\nwarehouse "), std::string::npos);
  EXPECT_NE(table.find("\nmedian "), std::string::npos);
  std::size_t charts = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos; at = page.find("<svg", at + 1)) {
    ++charts;
  }
  EXPECT_EQ(charts, 2U);
  EXPECT_EQ(page.find("http://www.w3.org/2000/svg") == std::string::npos, false);
}

TEST(Campaigns, HaveTheSizesThatTheirNamesPromise) {
  EXPECT_EQ(quick_campaign().drives.size(), 12U);
  EXPECT_EQ(quick_campaign().drives.front().duration_s, 60.0);
  EXPECT_EQ(full_campaign().drives.size(), 36U);
  EXPECT_EQ(full_campaign().drives.front().duration_s, 300.0);
}

}  // namespace
}  // namespace slamd::bench
