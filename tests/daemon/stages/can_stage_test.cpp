#include "daemon/stages/can_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "daemon/configuration/loader.hpp"
#include "tests/hex/hex.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::stages {
namespace {

using transport::CanFilter;
using transport::CanFrame;

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};

configuration::Configuration configured(const std::string& toml) {
  configuration::Loader loader;
  loader.add_text("[[lidar]]\nmodel = \"vlp16\"\n" + toml, "robot.toml");
  return loader.load();
}

CanFrame frame_of(std::uint32_t id, std::string_view hex) {
  const hex::Bytes bytes = hex::from_hex(hex);
  CanFrame frame{.id = id, .is_extended = id > 0x7FF, .size = static_cast<std::uint8_t>(bytes.size()), .data = {}, .received = kBegin};
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

constexpr const char* kXsens = "[imu]\nsource = \"can\"\ninterface = \"can0\"\nprotocol = \"xsens\"\n";
constexpr const char* kAceinna = "[imu]\nsource = \"can\"\ninterface = \"can0\"\nprotocol = \"aceinna\"\n";
constexpr const char* kWheels =
    "[wheel]\nsource = \"can\"\ninterface = \"can0\"\ntrack_m = 0.5\nleft = { id = 0x1A0, signed = true, scale = 0.001 }\n"
    "right = { id = 0x1A0, first_bit = 16, signed = true, scale = 0.001 }\n";

TEST(CanStage, ReadsAnXsens) {
  CanStage sut(configured(kXsens));
  sensor::ImuReading reading;

  EXPECT_FALSE(sut.take_imu(frame_of(0x005, "0314ED53"), reading));
  EXPECT_FALSE(sut.take_imu(frame_of(0x032, "0005FFF60100"), reading));
  ASSERT_TRUE(sut.take_imu(frame_of(0x034, "000DFFE109CF"), reading));

  EXPECT_EQ(reading.angular_rate_radps, Eigen::Vector3d(0.009765625, -0.01953125, 0.5));
  EXPECT_EQ(sut.imu_summary().samples, 1U);
  EXPECT_EQ(sut.inertial(), (NamedCounts{{"sample", 1}}));
  EXPECT_FALSE(sut.takes_wheels());
}

TEST(CanStage, ReadsAnAceinnaAsItsAxesAndAddressAreConfigured) {
  CanStage sut(configured(std::string(kAceinna) + "axis_map = \"x,-y,z\"\ncan_address = 0x80\n"));
  sensor::ImuReading reading;

  EXPECT_FALSE(sut.take_imu(frame_of(0x08F02D81, "0C7DDE7C2B790002"), reading));  // somebody else
  EXPECT_FALSE(sut.take_imu(frame_of(0x08F02D80, "0C7DDE7C2B790002"), reading));
  ASSERT_TRUE(sut.take_imu(frame_of(0x0CF02A80, "807DC07B008C0002"), reading));

  EXPECT_LT((reading.specific_force_mps2 - Eigen::Vector3d(0.12, 0.34, -9.81)).norm(), 1e-9);
}

TEST(CanStage, ReadsWheels) {
  CanStage sut(configured(kWheels));
  sensor::WheelSample sample;

  EXPECT_FALSE(sut.take_wheels(frame_of(0x1A0, "E8"), sample));
  ASSERT_TRUE(sut.take_wheels(frame_of(0x1A0, "E803DC05"), sample));

  EXPECT_DOUBLE_EQ(sample.speed_mps, 1.25);
  EXPECT_DOUBLE_EQ(sample.turn_rate_radps, 1.0);
  EXPECT_FALSE(sut.takes_imu());
  EXPECT_EQ(sut.wheels_refused(), 2U);  // both speeds of the short frame
  EXPECT_EQ(sut.wheels(), (NamedCounts{{"sample", 1}, {"malformed", 2}}));
}

TEST(CanStage, TakesNothingOfASensorThatIsSwitchedOffOrElsewhere) {
  EXPECT_FALSE(CanStage(configured("[imu]\nsource = \"udp\"\n")).takes_imu());
  EXPECT_FALSE(CanStage(configured(std::string(kXsens) + "enabled = false\n")).takes_imu());
  EXPECT_FALSE(CanStage(configured(std::string(kWheels) + "use = false\n")).takes_wheels());
}

TEST(CanStage, AsksTheKernelForTheFramesThatItReads) {
  const std::vector<CanFilter> xsens = imu_frames(configured(kXsens).imu);
  const std::vector<CanFilter> any = imu_frames(configured(kAceinna).imu);
  const std::vector<CanFilter> one = imu_frames(configured(std::string(kAceinna) + "can_address = 0x82\n").imu);
  const std::vector<CanFilter> wheels = wheel_frames(configured(kWheels).wheel);
  const auto passes = [](const std::vector<CanFilter>& filters, std::uint32_t id) {
    return std::any_of(filters.begin(), filters.end(), [&](const CanFilter& filter) {
      return (filter.id & filter.mask) == (id & filter.mask) && filter.is_extended == (id > 0x7FF);
    });
  };

  EXPECT_TRUE(passes(xsens, 0x005) && passes(xsens, 0x032) && passes(xsens, 0x062));
  EXPECT_FALSE(passes(xsens, 0x021));
  EXPECT_TRUE(passes(any, 0x08F02D80) && passes(any, 0x0CF02A93) && passes(any, 0x18FF6B80));
  EXPECT_FALSE(passes(any, 0x0CF02980));
  EXPECT_TRUE(passes(one, 0x08F02D82));
  EXPECT_FALSE(passes(one, 0x08F02D80));
  EXPECT_EQ(wheels, (std::vector<CanFilter>{{.id = 0x1A0}}));
}

TEST(CanStage, KnowsThatAnAceinnaIsStampedByItsArrival) {
  EXPECT_EQ(imu_clock(configured(kAceinna).imu).kind, sensor::ClockKind::kShared);
  EXPECT_EQ(imu_clock(configured(kXsens).imu).kind, sensor::ClockKind::kEstimated);
}

TEST(CanStage, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  CanStage sut(configured(std::string(kXsens) + kWheels));
  const CanFrame frames[] = {frame_of(0x005, "0314ED53"), frame_of(0x032, "0005FFF60100"), frame_of(0x034, "000DFFE109CF"),
                             frame_of(0x1A0, "E803DC05")};
  sensor::ImuReading reading;
  sensor::WheelSample sample;
  int complete = 0;

  const auto allocations = support::count_allocations([&] {
    for (const CanFrame& frame : frames) {
      complete += sut.take_imu(frame, reading) ? 1 : 0;
      complete += sut.take_wheels(frame, sample) ? 1 : 0;
    }
  });

  EXPECT_EQ(complete, 2);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::stages
