#include "tools/replay/motion_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/scratch/scratch_folder.hpp"
#include "tools/evaluate/motions.hpp"

namespace slamd::replay {
namespace {

constexpr Stamp kBegin = Stamp{} + std::chrono::nanoseconds(1'790'000'000'123'456'789);

Stamp at(int scan) { return kBegin + std::chrono::milliseconds(100 * scan); }

/// Twenty scans at rest, then `scans` more, 0.14 m apart.
MotionLog after_driving(int scans) {
  MotionLog log;
  for (int i = 0; i < 20 + scans; ++i) {
    odometry::MotionStep step;
    step.T_odom_base.translation().x() = 0.14 * std::max(0, i - 19);
    step.P_filter_base.topRows<6>() = 1e-4 * geometry::Matrix6d::Identity();
    step.transition.setZero();
    step.drift_base(1, 1) = 1e-6;
    log.add(at(i), step);
  }
  return log;
}

TEST(MotionLog, ClaimsEachMotionOfTenMetresOnce) {
  const auto sut = after_driving(100);  // 14 m

  ASSERT_EQ(sut.claims().size(), 29U);  // begun in the first 4 m; standing counts once
  EXPECT_EQ(sut.claims().front().first, at(0));
  EXPECT_EQ(sut.claims().front().last, at(19 + 72));
  EXPECT_GT(sut.claims().front().covariance(1, 1), 2e-4 + 90e-6);
  EXPECT_TRUE(after_driving(70).claims().empty());  // 9.8 m
}

class MotionFile : public scratch::ScratchFolder {};

TEST_F(MotionFile, IsReadAsItWasWritten) {
  const auto claims = after_driving(80).claims();
  {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen((folder_ / "motions.csv").c_str(), "wb"), std::fclose);
    write_motions(file.get(), claims);
  }

  const auto sut = evaluate::read_motions(folder_ / "motions.csv");

  ASSERT_EQ(sut.size(), claims.size());
  for (std::size_t i = 0; i < claims.size(); ++i) {
    EXPECT_EQ(sut[i].first, claims[i].first);
    EXPECT_EQ(sut[i].last, claims[i].last);
    EXPECT_TRUE(sut[i].covariance.isApprox(claims[i].covariance, 1e-6));
  }
}

}  // namespace
}  // namespace slamd::replay
