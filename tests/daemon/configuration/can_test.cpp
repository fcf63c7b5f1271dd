#include "daemon/configuration/can.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "daemon/configuration/loader.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::configuration {
namespace {

Configuration loaded(const std::string& toml) {
  Loader sut;
  sut.add_text("[[lidar]]\nmodel = \"vlp16\"\n" + toml, "robot.toml");
  return sut.load();
}

std::string refusal_of(const std::string& toml) {
  return scratch::message_of<ConfigurationError>([&] { loaded(toml); });
}

std::string imu(const std::string& rest) { return "[imu]\nsource = \"can\"\n" + rest; }
std::string wheel(const std::string& rest) { return "[wheel]\nsource = \"can\"\ninterface = \"can1\"\n" + rest; }

constexpr const char* kSpeeds =
    "left = { id = 0x1A0, first_bit = 0, bits = 16, signed = true, scale = 0.001 }\n"
    "right = { id = 0x18F00A27, extended = true, byte_order = \"big\", first_bit = 7, bits = 12, scale = 0.01, offset = -20.0 }\n";

TEST(CanConfiguration, TakesAnInertialSensor) {
  const Configuration configuration =
      loaded(imu("interface = \"can0\"\nprotocol = \"aceinna\"\naxis_map = \"x,y,-z\"\ncan_address = 0x81\n"));

  EXPECT_TRUE(configuration.imu.is_on_can());
  EXPECT_EQ(configuration.imu.interface, "can0");
  EXPECT_EQ(configuration.imu.protocol, imu::Protocol::kAceinna);
  EXPECT_EQ(configuration.imu.axis_map, "x,y,-z");
  EXPECT_EQ(configuration.imu.can_address, 0x81);
}

TEST(CanConfiguration, TakesWheelsAsADbcFileSaysThem) {
  const Configuration configuration = loaded(wheel(std::string("track_m = 0.62\n") + kSpeeds));

  const can::WheelSignals signals = wheel_signals(configuration.wheel);

  EXPECT_EQ(signals.model, can::WheelModel::kDifferential);
  EXPECT_EQ(signals.base_m, 0.62);
  EXPECT_EQ(signals.signals[0].id, 0x1A0U);
  EXPECT_TRUE(signals.signals[0].is_signed);
  EXPECT_FALSE(signals.signals[0].is_big_endian);
  EXPECT_EQ(signals.signals[0].scale, 0.001);
  EXPECT_EQ(signals.signals[1].id, 0x18F00A27U);
  EXPECT_TRUE(signals.signals[1].is_extended);
  EXPECT_TRUE(signals.signals[1].is_big_endian);
  EXPECT_EQ(signals.signals[1].first_bit, 7);
  EXPECT_EQ(signals.signals[1].bits, 12);
  EXPECT_FALSE(signals.signals[1].is_signed);
  EXPECT_EQ(signals.signals[1].offset, -20.0);
}

TEST(CanConfiguration, TakesASpeedAndASteeringAngle) {
  const Configuration configuration =
      loaded(wheel("model = \"ackermann\"\nwheelbase_m = 1.1\nspeed = { id = 1 }\nsteering = { id = 2, scale = -0.1 }\n"));

  const can::WheelSignals signals = wheel_signals(configuration.wheel);

  EXPECT_EQ(signals.model, can::WheelModel::kAckermann);
  EXPECT_EQ(signals.base_m, 1.1);
  EXPECT_EQ(signals.signals[0].id, 1U);
  EXPECT_EQ(signals.signals[1].id, 2U);
  EXPECT_EQ(signals.signals[1].scale, -0.1);
}

TEST(CanConfiguration, NeedsNoInterfaceForALog) {
  EXPECT_TRUE(loaded("[imu]\nsource = \"can.log\"\nprotocol = \"xsens\"\n").imu.is_on_can());
  EXPECT_FALSE(loaded("[imu]\nsource = \"imu.csv\"\n").imu.is_on_can());
}

TEST(CanConfiguration, IsPrintedWithTheSignalsThatItHas) {
  const std::string printed = print_configuration(loaded(wheel(kSpeeds)));
  Loader again;
  again.add_text(printed, "printed.toml");

  EXPECT_NE(printed.find("left.id = 416\n"), std::string::npos);
  EXPECT_NE(printed.find("right.byte_order = \"big\"\n"), std::string::npos);
  EXPECT_EQ(printed.find("steering"), std::string::npos);
  EXPECT_EQ(print_configuration(again.load()), printed);
}

TEST(CanConfiguration, IsRefusedInOneLine) {
  EXPECT_EQ(refusal_of(imu("interface = \"can0\"\n")),
            "imu.protocol = \"csv\": is not spoken on CAN; must be \"xsens\" or \"aceinna\"");
  EXPECT_EQ(refusal_of(imu("protocol = \"xsens\"\n")),
            "imu.interface: is needed by source = \"can\": the interface, such as \"can0\"");
  EXPECT_EQ(refusal_of(imu("protocol = \"xsens\"\ninterface = \"a/b\"\n")),
            "robot.toml:6: imu.interface = \"a/b\": must be the name of a network interface, up to 15 characters");
  EXPECT_EQ(refusal_of(imu("protocol = \"xsens\"\ninterface = \"can0\"\nrate_hz = 400\n")),
            "robot.toml:7: imu.rate_hz = 400: slamd only listens on CAN; must be 0");
  EXPECT_EQ(refusal_of(imu("protocol = \"aceinna\"\ninterface = \"can0\"\naxis_map = \"x,x,z\"\n")),
            "robot.toml:7: imu.axis_map = \"x,x,z\": must name x, y and z once each, such as \"y,x,z\" or \"y,x,-z\"");
  EXPECT_EQ(refusal_of("[imu]\nsource = \"serial\"\ndevice = \"/dev/ttyS0\"\nprotocol = \"aceinna\"\n"),
            "robot.toml:6: imu.protocol = \"aceinna\": is for imu.source = \"can\", or a candump log");
}

TEST(CanConfiguration, RefusesSignalsThatCannotBe) {
  EXPECT_EQ(refusal_of(wheel("left = { id = 1 }\n")),
            "wheel.right: is needed on CAN: { id = ..., first_bit = ..., bits = ..., scale = ... }");
  EXPECT_EQ(refusal_of(wheel("model = \"ackermann\"\nleft = { id = 1 }\nright = { id = 1 }\n")),
            "wheel.speed: is needed on CAN: { id = ..., first_bit = ..., bits = ..., scale = ... }");
  EXPECT_EQ(refusal_of(wheel("left = { id = 2048 }\nright = { id = 1 }\n")),
            "robot.toml:6: wheel.left.id = 2048: has more than 11 bits, which needs extended = true");
  EXPECT_EQ(refusal_of(wheel("left = { id = 1 }\nright = { id = 1, first_bit = 60, bits = 8 }\n")),
            "robot.toml:7: wheel.right.first_bit = 60: with this byte order and number of bits lies outside of a frame of 8 bytes");
  EXPECT_EQ(refusal_of(wheel("left = { id = 1, scale = 0.0 }\nright = { id = 1 }\n")),
            "robot.toml:6: wheel.left.scale = 0.0: must not be 0");
  EXPECT_EQ(refusal_of("[wheel]\nsource = \"can\"\nleft = { id = 1 }\nright = { id = 1 }\n"),
            "wheel.interface: is needed by source = \"can\": the interface, such as \"can0\"");
}

}  // namespace
}  // namespace slamd::configuration
