#include "daemon/devices/extrinsic_words.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geometry/so3.hpp"

namespace slamd::devices {
namespace {

constexpr livox::Sdk1Extrinsic kStored{{0.0F, 0.0F, 90.0F}, {100, -200, 300}};
constexpr const char* kIgnored = "it is not what lidar.T_base_lidar says, and slamd ignores it: only lidar.T_base_lidar is applied";

geometry::Se3 T_base_lidar(double yaw_deg, double x_m) {
  return {geometry::rotation_from_rpy({0.0, 0.0, yaw_deg * M_PI / 180.0}), {x_m, -0.2, 0.3}};
}

TEST(ExtrinsicRemark, IsEmptyWhereNoneIsStored) {
  EXPECT_EQ(extrinsic_remark({}, T_base_lidar(90.0, 0.1)), "");
}

TEST(ExtrinsicRemark, SaysThatWhatIsStoredTooIsAppliedOnce) {
  EXPECT_EQ(extrinsic_remark(kStored, T_base_lidar(90.05, 0.1005)), "it is what lidar.T_base_lidar says, which slamd applies, once");
}

TEST(ExtrinsicRemark, SaysThatAnotherOneIsIgnored) {
  EXPECT_EQ(extrinsic_remark(kStored, {}), kIgnored);
  EXPECT_EQ(extrinsic_remark(kStored, T_base_lidar(90.2, 0.1)), kIgnored);
  EXPECT_EQ(extrinsic_remark(kStored, T_base_lidar(90.0, 0.102)), kIgnored);
}

TEST(ExtrinsicRemark, IgnoresWhatIsNoNumber) {
  livox::Sdk1Extrinsic stored;
  stored.rpy_deg[0] = std::numeric_limits<float>::quiet_NaN();

  EXPECT_EQ(extrinsic_remark(stored, {}), kIgnored);
}

}  // namespace
}  // namespace slamd::devices
