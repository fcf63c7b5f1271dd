#include "tools/sensors/starting_configuration.hpp"

#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/configuration/loader.hpp"
#include "made_seen.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::sensors {
namespace {

using configuration::Configuration;
using configuration::LidarModel;
using testing::HasSubstr;
using testing::Not;

std::string written(const Seen& seen) { return starting_configuration(seen, "2026-11-28 07:00 UTC"); }

Configuration read_back(const std::string& toml) {
  configuration::Loader loader;
  loader.add_text(toml, "written.toml");
  return loader.load();
}

Seen with_lidar(const LidarSeen& lidar) {
  Seen seen = made_seen();
  seen.lidars = {lidar};
  return seen;
}

TEST(StartingConfiguration, TakesAnAviaByItsCodeWithItsOwnImu) {
  const Configuration sut = read_back(written(with_lidar(made_avia())));

  EXPECT_EQ(sut.lidar.model, LidarModel::kLivoxAvia);
  EXPECT_EQ(sut.lidar.device.code, "3JEDK380010Z391");
  EXPECT_EQ(sut.imu.source, "livox");
}

TEST(StartingConfiguration, TakesAVelodyneByItsAddressWithoutAnImu) {
  LidarSeen lidar = made_vlp16();
  lidar.port = 2370;

  const Configuration sut = read_back(written(with_lidar(lidar)));

  EXPECT_EQ(sut.lidar.model, LidarModel::kVlp16);
  EXPECT_EQ(sut.lidar.source_address, "10.77.0.2");
  EXPECT_EQ(sut.lidar.port, 2370);
  EXPECT_FALSE(sut.imu.enabled);
}

TEST(StartingConfiguration, TakesSensorsOnSerialLinesAsTheyWereHeard) {
  Seen seen = with_lidar(made_mid360());
  seen.lines = {made_receiver(), made_xsens()};

  const Configuration sut = read_back(written(seen));

  EXPECT_EQ(sut.imu.source, "serial");
  EXPECT_EQ(sut.imu.device, "/dev/ttyUSB0");
  EXPECT_EQ(sut.imu.baud, 115'200);
  EXPECT_EQ(sut.imu.protocol, imu::Protocol::kXsens);
  EXPECT_EQ(sut.imu.rate_hz, 0);
  EXPECT_EQ(sut.gnss.device, "/dev/ttyACM0");
  EXPECT_EQ(sut.gnss.baud, 38'400);
}

TEST(StartingConfiguration, HasASensorThatSendsNothingTold) {
  Seen seen = with_lidar(made_vlp16());
  seen.lines = {made_xsens()};
  seen.lines[0].imu = {};
  seen.lines[0].answers = true;

  EXPECT_EQ(read_back(written(seen)).imu.rate_hz, 200);
}

TEST(StartingConfiguration, TakesAnInertialSensorOnCanAndNamesTheOtherIds) {
  Seen seen = with_lidar(made_vlp16());
  BusSeen bus;
  bus.interface = "can0";
  bus.frames = {3000, 300};
  bus.xsens = made_xsens().imu;
  bus.ids = {{0x1A0, false, 8, {1000, 100}}};
  seen.buses = {bus};

  const std::string text = written(seen);
  const Configuration sut = read_back(text);

  EXPECT_EQ(sut.imu.source, "can");
  EXPECT_EQ(sut.imu.interface, "can0");
  EXPECT_EQ(sut.imu.protocol, imu::Protocol::kXsens);
  EXPECT_TRUE(sut.wheel.source.empty());
  EXPECT_THAT(text, HasSubstr("id 0x1A0, 8 bytes, 100 in the last second"));
}

TEST(StartingConfiguration, TakesRowsFromTheNetwork) {
  Seen seen = with_lidar(made_vlp16());
  seen.rows = {{kSensor, 7502, made_xsens().imu}};

  const Configuration sut = read_back(written(seen));

  EXPECT_EQ(sut.imu.source, "udp");
  EXPECT_EQ(sut.imu.port, 7502);
}

TEST(StartingConfiguration, TakesNoRowsForAnInertialSensorThatArriveWhereTheLidarSends) {
  Seen seen = with_lidar(made_vlp16());
  InertialSeen few = made_xsens().imu;
  few.samples.total = 1;
  seen.rows = {{kSensor, 8308, made_xsens().imu}, {kSensor, 7501, few}, {kSensor, 7502, made_xsens().imu}};

  EXPECT_EQ(read_back(written(seen)).imu.port, 7502);
  seen.rows.resize(1);
  EXPECT_TRUE(read_back(written(seen)).imu.source.empty());
}

TEST(StartingConfiguration, TakesTheReceiverBehindAVelodyne) {
  LidarSeen lidar = made_vlp16();
  lidar.sentence = "$GPRMC,";

  EXPECT_EQ(read_back(written(with_lidar(lidar))).gnss.source, "velodyne");
}

TEST(StartingConfiguration, HasAReasonBehindEachKey) {
  Seen seen = with_lidar(made_avia());
  seen.lines = {made_receiver(), made_xsens()};

  std::istringstream text(written(seen));

  int keys = 0;
  for (std::string line; std::getline(text, line);) {
    if (line.find(" = ") != std::string::npos && line[0] != '#') {
      ++keys;
      EXPECT_NE(line.find("# "), std::string::npos) << line;
    }
  }
  EXPECT_GE(keys, 12);
}

TEST(StartingConfiguration, ProposesARotationInWordsOnly) {
  Seen seen = with_lidar(made_vlp16());
  seen.lines = {made_xsens()};
  seen.lines[0].imu.mean_force_mps2 = {0.0, -9.81, 0.0};

  const std::string text = written(seen);
  const Configuration sut = read_back(text);

  EXPECT_THAT(text, HasSubstr("T_base_imu should have rpy_deg = [-90.0, 0.0, 0.0]"));
  ASSERT_TRUE(sut.imu.T_base_imu);
  EXPECT_EQ(sut.imu.T_base_imu->rotation(), Eigen::Matrix3d::Identity());
}

TEST(StartingConfiguration, PrefersALidarThatThisHostReaches) {
  Seen seen = with_lidar(made_vlp16());
  seen.lidars[0].address = 0xC0A801C9;
  seen.lidars.push_back(made_avia());

  const std::string text = written(seen);

  EXPECT_EQ(read_back(text).lidar.model, LidarModel::kLivoxAvia);
  EXPECT_THAT(text, HasSubstr("# Also seen: Velodyne VLP-16 at 192.168.1.201"));
}

TEST(StartingConfiguration, IsReadWhateverDevicesCallThemselves) {
  Seen seen = with_lidar(made_avia());
  seen.lidars[0].code = R"(x" \ # ' evil)";
  seen.lines = {made_xsens()};
  seen.lines[0].device = R"(/dev/serial/by-id/usb-"a\b"-if00)";

  const Configuration sut = read_back(written(seen));

  EXPECT_EQ(sut.lidar.device.code, "any");
  EXPECT_EQ(sut.imu.device, R"(/dev/serial/by-id/usb-"a\b"-if00)");
}

TEST(StartingConfiguration, IsNoneWithoutALidarThatIsRead) {
  Seen seen = made_seen();
  seen.lines = {made_xsens()};
  EXPECT_THROW(written(seen), std::runtime_error);

  LidarSeen horizon = made_avia();
  horizon.model.reset();
  EXPECT_THROW(written(with_lidar(horizon)), std::runtime_error);
}

TEST(StartingConfiguration, TakesALivoxThatSendsByItselfAtItsPort) {
  LidarSeen lidar = made_avia();
  lidar.broadcasts = {};
  lidar.model.reset();
  lidar.code.clear();
  lidar.port = 56001;

  const Configuration sut = read_back(written(with_lidar(lidar)));

  EXPECT_EQ(sut.lidar.model, LidarModel::kLivoxAvia);
  EXPECT_EQ(sut.lidar.port, 56001);
  EXPECT_TRUE(sut.lidar.device.code.empty());
}

class WriteFile : public scratch::ScratchFolder {};

TEST_F(WriteFile, TakesNoFilesPlaceUnlessItIsForced) {
  const std::filesystem::path file = write("slamd.toml", "mine");

  EXPECT_THAT(scratch::message_of<std::runtime_error>([&] { write_file(file, "new", false); }), HasSubstr("is there already"));
  EXPECT_EQ(text_of(file), "mine");

  write_file(file, "new", true);
  EXPECT_EQ(text_of(file), "new");
}

TEST_F(WriteFile, SaysWhyItCannot) {
  EXPECT_THAT(scratch::message_of<std::runtime_error>([&] { write_file(folder_ / "none" / "slamd.toml", "x", false); }),
              HasSubstr("cannot be written: No such file"));
}

}  // namespace
}  // namespace slamd::sensors
