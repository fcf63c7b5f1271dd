#include "tools/sensors/listening.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/configuration/loader.hpp"

namespace slamd::sensors {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

configuration::Configuration configuration_of(const std::string& toml) {
  configuration::Loader loader;
  loader.add_text(toml, "test.toml");
  return loader.load();
}

TEST(ListeningConfig, HasThePlacesOfAConfiguration) {
  ListeningConfig sut;
  sut.serial = {"/dev/ttyUSB7"};

  add_places_of(configuration_of("[[lidar]]\nmodel = \"vlp16\"\nport = 2370\nposition_port = 8310\n"
                                 "[imu]\nsource = \"serial\"\ndevice = \"/dev/imu\"\n"
                                 "[gnss]\nsource = \"serial\"\ndevice = \"/dev/gnss\"\n"),
                sut);

  EXPECT_THAT(sut.ports, ElementsAre(2370, 8310));
  EXPECT_THAT(sut.serial, ElementsAre("/dev/gnss", "/dev/imu", "/dev/ttyUSB7"));
  EXPECT_THAT(sut.can, IsEmpty());
}

TEST(ListeningConfig, HasTheBusOfAConfiguration) {
  ListeningConfig sut;

  add_places_of(configuration_of("[[lidar]]\nmodel = \"livox_mid360\"\n[imu]\nsource = \"can\"\nprotocol = \"xsens\"\ninterface = \"can3\"\n"), sut);

  EXPECT_THAT(sut.ports, ElementsAre(56301, 56401));
  EXPECT_THAT(sut.can, ElementsAre("can3"));
}

TEST(Listening, GoesThroughSecondsAndSaysWhatItHasSeen) {
  const transport::HostClock clock;
  Listening sut({.ports = {0}, .serial = {"/nowhere/tty"}, .can = {"slamd_none"}, .finds_serial = false, .avias = {}}, clock);

  for (int i = 0; i < 3; ++i) {
    sut.run_once(std::chrono::milliseconds(5));
    sut.end_second();
  }

  const Seen seen = sut.seen();
  EXPECT_GE(seen.listened_s, 0.0);
  EXPECT_EQ(seen.lines.at(0).device, "/nowhere/tty");
  EXPECT_NE(seen.lines.at(0).trouble, "");
  EXPECT_FALSE(seen.buses.empty());
  EXPECT_FALSE(seen.ports.empty());
}

}  // namespace
}  // namespace slamd::sensors
