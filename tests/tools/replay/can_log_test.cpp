#include "tools/replay/can_log.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "daemon/configuration/loader.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/replay/can_sender.hpp"

namespace slamd::replay {
namespace {

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};

class CanLog : public scratch::ScratchFolder {
 protected:
  static configuration::Configuration configured(const std::string& imu) {
    configuration::Loader loader;
    loader.add_text("[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"can.log\"\n" + imu +
                        "[wheel]\nsource = \"can.log\"\ntrack_m = 0.5\nleft = { id = 0x1A0, signed = true, scale = 0.001 }\n"
                        "right = { id = 0x1A0, first_bit = 16, signed = true, scale = 0.001 }\n",
                    "robot.toml");
    return loader.load();
  }

  template <typename Source, typename Sample>
  static std::vector<Sample> all(Source& source) {
    std::vector<Sample> samples;
    for (Sample sample; source.next(sample);) {
      samples.push_back(sample);
    }
    return samples;
  }
};

/// Two samples of an MTi-600 and one of the wheels, on a bus with others, and what is no frame.
constexpr const char* kXsens =
    "(1700000000.001000) can0 005#0314ED53\n(1700000000.001200) can0 032#0005FFF60100\n(1700000000.001300) can0 1A0#E803DC05\n"
    "(1700000000.001400) can0 034#000DFFE109CF\nnonsense\n(1700000000.002000) can1 123#00\n(1700000000.003000) can0 032#R\n"
    "(1700000000.003500) can0 005#0314ED6C\n(1700000000.003700) can0 032#0005FFF60100\n(1700000000.003900) can0 034#000DFFE109CF\n";

TEST_F(CanLog, GivesAnXsensSamplesOnTheTimeBase) {
  CanLogImu sut(write("can.log", kXsens), configured("protocol = \"xsens\"\n"));

  const auto samples = all<CanLogImu, sensor::ImuSample>(sut);

  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].stamp, kBegin + std::chrono::microseconds(1400));
  EXPECT_EQ(samples[1].stamp - samples[0].stamp, std::chrono::microseconds(2500));  // by the sensor's clock
  EXPECT_EQ(samples[0].angular_rate_radps.z(), 0.5);
  EXPECT_EQ(sut.counts(), (stages::NamedCounts{{"sample", 2}, {"other", 2}, {"refused_line_without_data", 1}, {"refused_line_malformed", 1}}));
}

TEST_F(CanLog, GivesFramesOfTheConfiguredInterfaceOnly) {
  CanLogImu sut(write("can.log", kXsens), configured("protocol = \"xsens\"\ninterface = \"can1\"\n"));

  EXPECT_TRUE((all<CanLogImu, sensor::ImuSample>(sut).empty()));
}

TEST_F(CanLog, StampsAnAceinnaByItsArrival) {
  CanLogImu sut(write("can.log", "(1700000000.004000) can0 08F02D80#0C7DDE7C2B790006\n(1700000000.004300) can0 0CF02A80#807DC07B008C0006\n"),
                configured("protocol = \"aceinna\"\n"));

  const auto samples = all<CanLogImu, sensor::ImuSample>(sut);

  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].stamp, kBegin + std::chrono::microseconds(1300));
}

TEST_F(CanLog, GivesTheWheels) {
  CanLogWheels sut(write("can.log", kXsens), configured("protocol = \"xsens\"\n"));

  const auto samples = all<CanLogWheels, sensor::WheelSample>(sut);

  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].stamp, kBegin + std::chrono::microseconds(1300));
  EXPECT_DOUBLE_EQ(samples[0].speed_mps, 1.25);
  EXPECT_DOUBLE_EQ(samples[0].turn_rate_radps, 1.0);
}

TEST(CanSender, SaysWhichInterfaceItCannotSendTo) {
  const std::string said = scratch::message_of<std::runtime_error>([] { const CanSender sut("nowhere0"); });

  EXPECT_EQ(said.rfind("CAN interface nowhere0: ", 0), 0U) << said;
}

}  // namespace
}  // namespace slamd::replay
