#include "daemon/configuration/loader.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "tests/scratch/scratch_folder.hpp"

namespace slamd::configuration {
namespace {

namespace fs = std::filesystem;
using LoaderTest = scratch::ScratchFolder;

Configuration loaded(const std::string& toml, const std::vector<std::string>& overrides = {}) {
  Loader sut;
  sut.add_text(toml, "robot.toml");
  for (const std::string& key_value : overrides) {
    sut.add_override(key_value);
  }
  return sut.load();
}

TEST_F(LoaderTest, LoadsEachShippedFile) {
  std::set<std::string> models;
  for (const fs::directory_entry& entry : fs::directory_iterator(SLAMD_SOURCE_DIR "/config")) {
    ASSERT_EQ(entry.path().extension(), ".toml") << entry.path();
    Loader sut;
    sut.add_file(entry.path());

    const Configuration configuration = sut.load();

    models.insert(name_of(configuration.lidar.model));
  }
  EXPECT_GE(models.size(), 6U);
}

TEST_F(LoaderTest, LinksInThePresetsThatAreShipped) {
  for (const std::string& model : find_key("lidar.model")->choices) {
    const Configuration configuration = loaded("[[lidar]]\nmodel = \"" + model + "\"\n");

    EXPECT_EQ(preset_of(configuration.lidar.model), text_of(fs::path(SLAMD_SOURCE_DIR "/config") / (model + ".toml")));
  }
}

TEST_F(LoaderTest, TakesAModelAsAWholeConfiguration) {
  const Configuration configuration = loaded("[[lidar]]\nmodel = \"vlp16\"\n");

  EXPECT_EQ(configuration.lidar.model, LidarModel::kVlp16);
  EXPECT_FALSE(configuration.imu.enabled);
}

TEST_F(LoaderTest, FillsInWhatTheModelsPresetSays) {
  EXPECT_FLOAT_EQ(loaded("[[lidar]]\nmodel = \"vlp16\"\n").odometry.preprocess.self_filter.max_range_m, 100.0F);
  EXPECT_FLOAT_EQ(loaded("[[lidar]]\nmodel = \"livox_avia\"\n").odometry.preprocess.self_filter.max_range_m, 200.0F);
  EXPECT_FLOAT_EQ(loaded("[[lidar]]\nmodel = \"livox_mid360\"\n").odometry.preprocess.self_filter.max_range_m, 70.0F);
}

TEST_F(LoaderTest, LetsAFileWinOverThePresetAndAnOverrideOverTheFile) {
  const std::string toml = "[[lidar]]\nmodel = \"vlp16\"\nmax_range_m = 80\n";

  EXPECT_FLOAT_EQ(loaded(toml).odometry.preprocess.self_filter.max_range_m, 80.0F);
  EXPECT_FLOAT_EQ(loaded(toml, {"lidar.max_range_m=60"}).odometry.preprocess.self_filter.max_range_m, 60.0F);
}

TEST_F(LoaderTest, LetsALaterFileWinKeyByKey) {
  Loader sut;
  sut.add_text("[[lidar]]\nmodel = \"vlp16\"\nport = 3000\n[odometry]\nseed = 4\n", "recording.toml");
  sut.add_text("[odometry]\nseed = 5\n[[lidar]]\nmin_range_m = 2.0\n", "mine.toml");

  const Configuration configuration = sut.load();

  EXPECT_EQ(configuration.lidar.port, 3000);
  EXPECT_EQ(configuration.odometry.seed, 5U);
  EXPECT_FLOAT_EQ(configuration.odometry.preprocess.self_filter.min_range_m, 2.0F);
}

TEST_F(LoaderTest, TakesOverridesWhateverIsAddedAfterThem) {
  Loader sut;
  sut.add_override("odometry.seed=9");
  sut.add_text("[[lidar]]\nmodel = \"vlp16\"\n[odometry]\nseed = 4\n", "robot.toml");

  EXPECT_EQ(sut.load().odometry.seed, 9U);
}

TEST_F(LoaderTest, TakesTextOfAnOverrideWithOrWithoutQuotes) {
  const std::string toml = "[[lidar]]\nmodel = \"vlp16\"\n";

  EXPECT_EQ(loaded(toml, {"lidar.source=day one.pcap"}).lidar.source, "day one.pcap");
  EXPECT_EQ(loaded(toml, {"lidar.source=\"a=b.pcap\""}).lidar.source, "a=b.pcap");
  EXPECT_EQ(loaded(toml, {"odometry.filter=iekf"}).odometry.filter, odometry::Filter::kIekf);
}

TEST_F(LoaderTest, TakesAnEmptyImuTableAsASensor) {
  EXPECT_TRUE(loaded("[[lidar]]\nmodel = \"vlp16\"\n[imu]\n").imu.enabled);
}

TEST_F(LoaderTest, LetsTheImuBeSwitchedOff) {
  EXPECT_FALSE(loaded("[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"imu.csv\"\n", {"imu.enabled=false"}).imu.enabled);
}

TEST_F(LoaderTest, ReadsRotationsAsYawOfPitchOfRoll) {
  const Configuration configuration =
      loaded("[[lidar]]\nmodel = \"vlp16\"\nT_base_lidar = { xyz_m = [1, 2, 3], rpy_deg = [90.0, 0.0, 90.0] }\n");

  const Eigen::Vector3d p_base = configuration.lidar.T_base_lidar * Eigen::Vector3d(0.0, 1.0, 0.0);

  EXPECT_LT((p_base - Eigen::Vector3d(1.0, 2.0, 4.0)).norm(), 1e-12);
}

TEST_F(LoaderTest, TakesThePortsOfALiveImu) {
  const Configuration udp = loaded("[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"udp\"\n");
  const Configuration serial =
      loaded("[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"serial\"\ndevice = \"/dev/ttyS1\"\nbaud = 115200\nprotocol = \"mip\"\nrate_hz = 250\n");

  EXPECT_TRUE(udp.imu.is_live_port());
  EXPECT_EQ(udp.imu.port, 7501);
  EXPECT_TRUE(serial.imu.is_live_port());
  EXPECT_EQ(serial.imu.device, "/dev/ttyS1");
  EXPECT_EQ(serial.imu.baud, 115'200);
  EXPECT_EQ(serial.imu.protocol, imu::Protocol::kMip);
  EXPECT_EQ(serial.imu.rate_hz, 250);
  EXPECT_EQ(udp.imu.protocol, imu::Protocol::kCsv);
}

TEST_F(LoaderTest, KnowsThePortOfEachModelsData) {
  EXPECT_EQ(loaded("[[lidar]]\nmodel = \"vlp16\"\n").lidar.data_port(), 2368);
  EXPECT_EQ(loaded("[[lidar]]\nmodel = \"vlp16\"\nport = 2400\n").lidar.data_port(), 2400);
  EXPECT_EQ(loaded("[[lidar]]\nmodel = \"livox_avia\"\n").lidar.data_port(), 0);
  EXPECT_EQ(loaded("[[lidar]]\nmodel = \"livox_mid360\"\n").lidar.data_port(), 0);
}

TEST_F(LoaderTest, PlacesTheAviasOwnImuFromItsLidar) {
  const Configuration configuration = loaded(
      "[[lidar]]\nmodel = \"livox_avia\"\nT_base_lidar = { xyz_m = [0.04165, 0.02326, -0.0284] }\n[imu]\nsource = \"livox\"\n");

  EXPECT_LT(resolved_odometry(configuration).T_base_imu.translation().norm(), 1e-12);
}

TEST_F(LoaderTest, PlacesTheMid360sOwnImuFromItsLidar) {
  const Configuration configuration = loaded(
      "[[lidar]]\nmodel = \"livox_mid360\"\nT_base_lidar = { xyz_m = [-0.011, -0.02329, 0.04412] }\n[imu]\nsource = \"livox\"\n");

  EXPECT_LT(resolved_odometry(configuration).T_base_imu.translation().norm(), 1e-12);
}

}  // namespace
}  // namespace slamd::configuration
