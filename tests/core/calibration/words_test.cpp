#include "core/base/units.hpp"
#include "core/calibration/words.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::calibration {
namespace {


TEST(Complaints, AreNoneWhereAllAgrees) {
  SensorAgreement agreement;
  agreement.lidar_imu = {{4e-4, 3e-4}, {Estimate{0.002, 0.003}, {}, {}}, 6, true};
  agreement.gravity = {{0.01, 0.006}, {0.0, 0.006}, 100.0, true};

  EXPECT_TRUE(complaints(agreement, 0.0, geometry::Se3{}).empty());
}

TEST(Complaints, ProposeTheOffsetOnTopOfTheConfigured) {
  SensorAgreement agreement;
  agreement.lidar_imu.offset_s = {-0.0081, 4e-4};
  agreement.lidar_imu.known = true;

  const auto lines = complaints(agreement, 0.002, geometry::Se3{});

  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "imu stamps are 8.1 ms early (1σ 0.4 ms): imu.offset_ms = -6.1");
}

TEST(Complaints, ProposeThePlaceThatUndoesTheRotation) {
  SensorAgreement agreement;
  agreement.lidar_imu.rotation_rad[1] = {3.0 * kDegree, 0.1 * kDegree};
  agreement.lidar_imu.known = true;
  geometry::Se3 T_base_imu;
  T_base_imu.rotation() = geometry::rotation_from_rpy({0.0, 3.0 * kDegree, 0.0});

  const auto lines = complaints(agreement, 0.0, T_base_imu);

  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "imu turned 3.0° about y: imu.T_base_imu rpy_deg = [0.0, 0.0, 0.0]");
}

TEST(Complaints, LeaveOutAnAxisThatTheDriveHardlyShows) {
  SensorAgreement agreement;
  agreement.lidar_imu.rotation_rad[2] = {3.0 * kDegree, 0.5 * kDegree};
  agreement.lidar_imu.known = true;

  EXPECT_TRUE(complaints(agreement, 0.0, geometry::Se3{}).empty());
}

TEST(Complaints, SayThatBaseLeans) {
  SensorAgreement agreement;
  agreement.gravity = {{5.0 * kDegree, 0.5 * kDegree}, {0.0, 0.5 * kDegree}, 100.0, true};

  const auto lines = complaints(agreement, 0.0, geometry::Se3{});

  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0], "base leans 5.0° roll, 0.0° pitch to gravity: T_base_imu, T_base_lidar right?");
}

TEST(Complaints, WaitUntilTheyAreKnown) {
  SensorAgreement agreement;
  agreement.lidar_imu.offset_s = {0.02, 1e-4};

  EXPECT_TRUE(complaints(agreement, 0.0, geometry::Se3{}).empty());
  EXPECT_EQ(offset_in_words(agreement.lidar_imu), "not known to a millisecond after 0 windows of 10 s");
}

}  // namespace
}  // namespace slamd::calibration
