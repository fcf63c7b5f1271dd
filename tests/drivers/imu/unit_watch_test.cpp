#include "drivers/imu/unit_watch.hpp"

#include <gtest/gtest.h>

namespace slamd::imu {
namespace {

/// What 2.5 s of samples at 100 Hz look like.
Units units_of(const Eigen::Vector3d& force_mps2, const Eigen::Vector3d& rate_radps) {
  UnitWatch sut;
  for (int i = 0; i < 250; ++i) {
    sut.add({DeviceStamp{std::chrono::milliseconds{10 * i}}, Stamp{}, rate_radps, force_mps2});
  }
  return sut.units();
}

TEST(UnitWatch, IsContentWithSiUnitsAtRestAndInMotion) {
  EXPECT_EQ(units_of({0.0, 0.0, 9.81}, {0.0, 0.0, 0.0}), Units::kSi);
  EXPECT_EQ(units_of({4.0, -3.0, 12.0}, {0.5, 0.5, 3.0}), Units::kSi);
  EXPECT_STREQ(in_words(Units::kSi), "");
}

TEST(UnitWatch, RecognisesForceInG) {
  EXPECT_EQ(units_of({0.02, -0.01, -0.98}, {0.0, 0.0, 0.0}), Units::kInG);
  EXPECT_STREQ(in_words(Units::kInG), "specific force looks like g, and must be m/s^2");
}

TEST(UnitWatch, RecognisesForceWithoutGravity) {
  EXPECT_EQ(units_of({0.1, 0.05, -0.1}, {0.0, 0.0, 0.01}), Units::kNoGravity);
}

TEST(UnitWatch, RecognisesTurnRatesInDegrees) {
  EXPECT_EQ(units_of({0.0, 0.0, 9.81}, {0.0, 0.0, 34.0}), Units::kInDegrees);
}

TEST(UnitWatch, SaysNothingBeforeASecondHasPassed) {
  UnitWatch sut;
  for (int i = 0; i < 99; ++i) {
    sut.add({DeviceStamp{std::chrono::milliseconds{10 * i}}, Stamp{}, Eigen::Vector3d::Zero(), {0.0, 0.0, 1.0}});
  }

  EXPECT_EQ(sut.units(), Units::kUnknown);
}

TEST(UnitWatch, ChangesItsMindWhenTheSensorDoes) {
  UnitWatch sut;
  for (int i = 0; i < 500; ++i) {
    const double force = i < 250 ? 1.0 : 9.81;
    sut.add({DeviceStamp{std::chrono::milliseconds{10 * i}}, Stamp{}, Eigen::Vector3d::Zero(), {0.0, 0.0, force}});
  }

  EXPECT_EQ(sut.units(), Units::kSi);
}

}  // namespace
}  // namespace slamd::imu
