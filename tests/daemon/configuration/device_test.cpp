#include "daemon/configuration/device.hpp"

#include <gtest/gtest.h>

#include "daemon/configuration/loader.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::configuration {
namespace {

Configuration loaded(const std::string& toml) {
  Loader sut;
  sut.add_text(toml, "robot.toml");
  return sut.load();
}

std::string refusal_of(const std::string& toml) {
  return scratch::message_of<ConfigurationError>([&] { loaded(toml); });
}

std::string avia(const std::string& rest) { return "[[lidar]]\nmodel = \"livox_avia\"\n" + rest; }
std::string mid360(const std::string& rest) { return "[[lidar]]\nmodel = \"livox_mid360\"\n" + rest; }

TEST(DeviceConfiguration, IsLeftToOthersUnlessACodeIsThere) {
  EXPECT_FALSE(loaded(avia("")).lidar.device.is_kept());
  EXPECT_TRUE(loaded(avia("device = { code = \"any\" }\n")).lidar.device.is_kept());
}

TEST(DeviceConfiguration, TakesATableOfItsOwn) {
  const Configuration configuration =
      loaded(avia("[lidar.device]\ncode = \"3JEDK380010Z391\"\ncoordinates = \"spherical\"\nreturns = \"dual\"\n"));

  EXPECT_EQ(configuration.lidar.device.code, "3JEDK380010Z391");
  EXPECT_EQ(configuration.lidar.device.coordinates, DeviceCoordinates::kSpherical);
  EXPECT_EQ(configuration.lidar.device.returns, DeviceReturns::kDual);
}

TEST(DeviceConfiguration, HasTheSdksPortsUnlessOthersAreConfigured) {
  EXPECT_EQ(loaded(avia("")).lidar.command_port(), 55501);
  EXPECT_EQ(loaded(mid360("")).lidar.command_port(), 56101);
  EXPECT_EQ(loaded(mid360("device.command_port = 7000\n")).lidar.command_port(), 7000);
  EXPECT_EQ(loaded(avia("")).lidar.listening_port(), 56001);
  EXPECT_EQ(loaded(mid360("")).lidar.listening_port(), 56301);
  EXPECT_EQ(loaded(avia("port = 7001\n")).lidar.listening_port(), 7001);
}

TEST(DeviceConfiguration, MayHaveAMid360sSamplesAmongItsPoints) {
  EXPECT_TRUE(loaded(mid360("device.code = \"any\"\nport = 56401\n")).lidar.device.is_kept());
}

TEST(DeviceConfiguration, TellsAnAviaTheTimeOnlyFromAReceiver) {
  const std::string receiver = "[gnss]\nsource = \"serial\"\ndevice = \"/dev/ttyACM0\"\n";
  const std::string kept = "device = { code = \"any\", set_utc = true }\n";

  EXPECT_TRUE(loaded(avia(kept) + receiver).lidar.device.set_utc);
  EXPECT_EQ(refusal_of(avia(kept)), "robot.toml:3: lidar.device.set_utc = true: needs gnss.source = \"serial\"");
  for (const std::string& wrong : {avia("device.set_utc = true\n"), mid360(kept)}) {
    EXPECT_EQ(refusal_of(wrong + receiver),
              "robot.toml:3: lidar.device.set_utc = true: is for a Livox Avia that slamd keeps; see lidar.device.code");
  }
}

TEST(DeviceConfiguration, IsRefusedInOneLine) {
  EXPECT_EQ(refusal_of("[[lidar]]\nmodel = \"vlp16\"\ndevice.code = \"any\"\n"),
            "robot.toml:3: lidar.device.code = \"any\": slamd talks to Livox devices only; lidar.model is none");
  EXPECT_EQ(refusal_of(avia("device.code = \"3JEDK-1\"\n")),
            "robot.toml:3: lidar.device.code = \"3JEDK-1\": must be \"any\", or up to 16 letters and digits: an Avia's "
            "broadcast code, a Mid-360's serial number");
  EXPECT_EQ(refusal_of(mid360("device = { code = \"any\", returns = \"dual\" }\n")),
            "robot.toml:3: lidar.device.returns: a Mid-360 has no return modes; must be \"unchanged\"");
  EXPECT_EQ(refusal_of(avia("port = 55501\ndevice.code = \"any\"\n")),
            "lidar.device.command_port = 55501: is another port of the device's");
  EXPECT_EQ(refusal_of(mid360("device = { code = \"any\", state_port = 56101 }\n")),
            "robot.toml:3: lidar.device.state_port = 56101: is another port of the device's");
  EXPECT_EQ(refusal_of(avia("device = 4\n")),
            "robot.toml:3: lidar.device = 4: must be a table of code, coordinates, returns, take_over, set_utc, command_port, "
            "state_port");
}

}  // namespace
}  // namespace slamd::configuration
