#include "tools/replay/recording.hpp"

#include <gtest/gtest.h>

#include "drivers/recording/packet.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::replay {
namespace {

using configuration::ConfigurationError;
using recording::RecordingError;
using scratch::message_of;

class OpenRecording : public scratch::ScratchFolder {
 protected:
  OpenRecording() {
    write("day/lidar.pcap", "not read here");
    write("day/imu.csv", "not read here");
    write("day/recording.toml", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\n");
  }

  std::filesystem::path day() const { return folder_ / "day"; }

  template <typename Error>
  std::string refusal_of(const std::filesystem::path& path, const std::vector<std::string>& configs = {},
                         const std::vector<std::string>& overrides = {}) const {
    return message_of<Error>([&] { open_recording(path, configs, overrides); });
  }
};

TEST_F(OpenRecording, FindsTheOnlyCaptureAndTheImuOfADirectory) {
  const Recording sut = open_recording(day(), {}, {});

  EXPECT_EQ(sut.lidar, day() / "lidar.pcap");
  EXPECT_EQ(sut.imu_csv, day() / "imu.csv");
  EXPECT_TRUE(sut.truth.empty());
}

TEST_F(OpenRecording, TakesTheTruthAlongWhereThereIsOne) {
  write("day/truth.tum", "");

  EXPECT_EQ(open_recording(day(), {}, {}).truth, day() / "truth.tum");
}

TEST_F(OpenRecording, LeavesTheImuOutWhenItIsSwitchedOff) {
  EXPECT_TRUE(open_recording(day(), {}, {"imu.enabled=false"}).imu_csv.empty());
}

TEST_F(OpenRecording, FindsWhatTheLivePortsOfAConfigurationHaveRecorded) {
  for (const char* source : {"imu.source=udp", "imu.source=serial"}) {
    EXPECT_EQ(open_recording(day(), {}, {source, "imu.device=/dev/ttyS0"}).imu_csv, day() / "imu.csv");
  }
}

TEST_F(OpenRecording, FindsTheLogOfABus) {
  write("day/can.log", "not read here");
  write("day/wheels.log", "not read here");
  const std::vector<std::string> on_can{"imu.protocol=xsens", "wheel.left.id=1", "wheel.right.id=1"};
  const auto opened = [&](std::vector<std::string> more) {
    more.insert(more.end(), on_can.begin(), on_can.end());
    return open_recording(day(), {}, more);
  };

  const Recording named = opened({"imu.source=can.log", "wheel.source=wheels.log"});
  const Recording live = opened({"imu.source=can", "imu.interface=can0", "wheel.source=can", "wheel.interface=can0"});

  EXPECT_EQ(named.imu_can, day() / "can.log");
  EXPECT_EQ(named.wheel_can, day() / "wheels.log");
  EXPECT_TRUE(named.imu_csv.empty() && named.wheel_csv.empty());
  EXPECT_EQ(live.imu_can, day() / "can.log");
  EXPECT_EQ(live.wheel_can, day() / "can.log");
  EXPECT_EQ(refusal_of<RecordingError>(day(), {}, {"imu.source=other.log", "imu.protocol=xsens"}),
            (day() / "other.log").string() + ": does not exist (imu.source)");
}

TEST_F(OpenRecording, RefusesALivePortWhereNothingOfItIsRecorded) {
  std::filesystem::remove(day() / "imu.csv");

  EXPECT_EQ(refusal_of<RecordingError>(day(), {}, {"imu.source=udp"}),
            (day() / "imu.csv").string() + ": does not exist, and imu.source = \"udp\" is for the live daemon; name the "
                                           "recording's file, or \"livox\"");
}

TEST_F(OpenRecording, LetsConfigFilesWinOverTheRecordingsOwn) {
  const auto mine = write("mine.toml", "[odometry]\nfilter = \"iekf\"\n[[lidar]]\nmin_range_m = 3\n");

  const Recording sut = open_recording(day(), {mine}, {"odometry.seed=8"});

  EXPECT_EQ(sut.configuration.odometry.filter, odometry::Filter::kIekf);
  EXPECT_EQ(sut.configuration.odometry.seed, 8U);
  EXPECT_EQ(sut.configuration.lidar.model, configuration::LidarModel::kVlp16);
}

TEST_F(OpenRecording, TakesABareCaptureWithAConfiguration) {
  const auto mine = write("mine.toml", "[[lidar]]\nmodel = \"vlp16\"\n");

  const Recording sut = open_recording(day() / "lidar.pcap", {mine}, {});

  EXPECT_EQ(sut.lidar, day() / "lidar.pcap");
  EXPECT_TRUE(sut.imu_csv.empty());
}

TEST_F(OpenRecording, RefusesABareCaptureWithoutOne) {
  EXPECT_EQ(refusal_of<ConfigurationError>(day() / "lidar.pcap"),
            (day() / "lidar.pcap").string() + ": has no recording.toml; say what the sensor is with --config FILE");
}

TEST_F(OpenRecording, SaysWhichFileIsMissingAndWhoAsksForIt) {
  EXPECT_EQ(refusal_of<RecordingError>(folder_ / "night"), (folder_ / "night").string() + ": does not exist");
  EXPECT_EQ(refusal_of<RecordingError>(day(), {}, {"lidar.source=other.pcap"}),
            (day() / "other.pcap").string() + ": does not exist (lidar.source)");
  EXPECT_EQ(refusal_of<RecordingError>(day(), {}, {"imu.source=other.csv"}),
            (day() / "other.csv").string() + ": does not exist (imu.source)");
}

TEST_F(OpenRecording, GoesOnWithoutFixesThatNothingUses) {
  const auto counted = write("counted.toml", "[[lidar]]\nmodel = \"vlp16\"\n[gnss]\nsource = \"gnss.csv\"\n");
  const auto used = write("used.toml", "[[lidar]]\nmodel = \"vlp16\"\n[gnss]\nuse = true\nsource = \"gnss.csv\"\n");

  EXPECT_TRUE(open_recording(day(), {counted}, {}).gnss.empty());
  EXPECT_THROW(open_recording(day(), {used}, {}), recording::RecordingError);
}

TEST_F(OpenRecording, AsksWhichCaptureWhenThereAreSeveral) {
  write("day/second.pcapng", "");

  EXPECT_EQ(refusal_of<RecordingError>(day()), day().string() + ": holds several captures; name one with lidar.source");
  EXPECT_EQ(open_recording(day(), {}, {"lidar.source=second.pcapng"}).lidar, day() / "second.pcapng");
}

TEST_F(OpenRecording, SaysThatThereIsNoCapture) {
  std::filesystem::remove(day() / "lidar.pcap");

  EXPECT_EQ(refusal_of<RecordingError>(day()), day().string() + ": holds no capture (*.pcap, *.pcapng)");
}

}  // namespace
}  // namespace slamd::replay
