#include "tools/import/bag_import.hpp"

#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include <cstring>

#include "drivers/clouds/point_folder.hpp"
#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/packet.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "ros_bytes.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::importing {

/// A message of any type, already serialized.
struct AnyMessage {
  std::vector<std::byte> bytes;
  std::string type;
};

}  // namespace slamd::importing

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<slamd::importing::AnyMessage> {
  static const char* value(const slamd::importing::AnyMessage&) {
    return "0123456789abcdef0123456789abcdef";
  }
};

template <>
struct DataType<slamd::importing::AnyMessage> {
  static const char* value(const slamd::importing::AnyMessage& message) {
    return message.type.c_str();
  }
};

template <>
struct Definition<slamd::importing::AnyMessage> {
  static const char* value(const slamd::importing::AnyMessage&) { return "uint8 unused\n"; }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<slamd::importing::AnyMessage> {
  template <typename Stream>
  static void write(Stream& stream, const slamd::importing::AnyMessage& message) {
    const auto size = static_cast<std::uint32_t>(message.bytes.size());
    std::memcpy(stream.advance(size), message.bytes.data(), size);
  }

  static std::uint32_t serializedLength(const slamd::importing::AnyMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros

namespace slamd::importing {
namespace {

const auto kQuiet = [](double) {
};

class BagImportTest : public scratch::ScratchFolder {
 protected:
  BagImportTest() : bag_((folder_ / "in.bag").string(), rosbag::bagmode::Write) {}

  void add(const std::string& topic, const std::string& type, std::vector<std::byte> bytes) {
    bag_.write(
        topic, ros::Time(1'700'000'000 + ++messages_, 0), AnyMessage{std::move(bytes), type});
  }

  Summary import(const BagOptions& options = {}) {
    bag_.close();
    std::filesystem::create_directories(folder_ / "out");
    return import_bag(folder_ / "in.bag", folder_ / "out", options, kQuiet);
  }

  rosbag::Bag bag_;
  std::uint32_t messages_ = 0;
};

TEST_F(BagImportTest, TurnsVelodyneScansIntoACapture) {
  bag_.setCompression(rosbag::compression::BZ2);
  add("/velodyne_packets", "velodyne_msgs/VelodyneScan", velodyne_message(5, 3, 0x28));
  add("/velodyne_packets", "velodyne_msgs/VelodyneScan", velodyne_message(6, 2, 0x28));
  add("/velodyne_packets", "velodyne_msgs/VelodyneScan", std::vector<std::byte>(40));
  add("/velodyne_points", "sensor_msgs/PointCloud2", cloud_message(5, 3));
  add("/imu", "sensor_msgs/Imu", imu_message(5, 0, 9.81));

  const Summary summary = import();

  EXPECT_EQ(summary.packets, 5U);
  EXPECT_EQ(summary.refused.at("malformed_lidar_message"), 1U);
  EXPECT_EQ(summary.imu_samples, 1U);
  recording::PcapReader pcap(folder_ / "out/lidar.pcap");
  recording::Packet packet;
  std::size_t packets = 0;
  while (pcap.next(packet)) {
    EXPECT_EQ(packet.destination_port, 2368);
    EXPECT_EQ(packet.payload.size(), 1206U);
    ++packets;
  }
  EXPECT_EQ(packets, 5U);
  EXPECT_EQ(packet.received.time_since_epoch().count(), 6'001'000'000);
  EXPECT_NE(text_of(folder_ / "out/recording.toml").find("model = \"vlp32c\""), std::string::npos);
}

TEST_F(BagImportTest, TurnsLivoxMessagesIntoCloudsAndGIntoSi) {
  bag_.setCompression(rosbag::compression::LZ4);
  for (std::uint32_t i = 0; i < 3; ++i) {
    add("/livox/lidar", "livox_ros_driver/CustomMsg", livox_message(10 + i, 10));
    add("/livox/imu", "sensor_msgs/Imu", imu_message(10 + i, 0, 1.0));
  }

  const Summary summary = import();

  EXPECT_EQ(summary.scans, 3U);
  clouds::PointFolderReader clouds(folder_ / "out/lidar", {});
  sensor::Scan scan(100);
  ASSERT_TRUE(clouds.next(scan));
  ASSERT_EQ(scan.points.size(), 10U);
  EXPECT_EQ(scan.begin.time_since_epoch().count(), 10'000'000'005);
  EXPECT_EQ(scan.points[7].offset_ns, 70'000'000U);
  EXPECT_EQ(scan.points[7].line, 1);
  EXPECT_EQ(scan.points[7].tag, 0x10);
  EXPECT_EQ(scan.points[7].intensity, 77);
  recording::ImuCsvReader imu(folder_ / "out/imu.csv");
  sensor::ImuSample sample;
  ASSERT_TRUE(imu.next(sample));
  EXPECT_NEAR(sample.specific_force_mps2.z(), 9.80665, 1e-6);
}

TEST_F(BagImportTest, KeepsTimeAndRingOfPointClouds) {
  add("/points", "sensor_msgs/PointCloud2", cloud_message(20, 10));
  add("/points", "sensor_msgs/PointCloud2", cloud_message(20, 10));

  const Summary summary = import();

  EXPECT_EQ(summary.scans, 1U);
  EXPECT_EQ(summary.refused.at("stamp_not_increasing"), 1U);
  clouds::PointFolderReader clouds(folder_ / "out/lidar", {});
  sensor::Scan scan(100);
  ASSERT_TRUE(clouds.next(scan));
  EXPECT_TRUE(scan.points_have_time);
  EXPECT_NEAR(to_seconds(scan.begin.time_since_epoch()), 19.91, 1e-6);
  EXPECT_EQ(scan.points[9].line, 9);
  EXPECT_NEAR(scan.points[9].offset_ns, 90'000'000, 100);
}

TEST_F(BagImportTest, ImportsTheTopicThatIsAskedFor) {
  add("/front", "sensor_msgs/PointCloud2", cloud_message(20, 10));
  add("/rear", "sensor_msgs/PointCloud2", cloud_message(20, 4));
  add("/rear", "sensor_msgs/PointCloud2", cloud_message(21, 4));
  BagOptions options;
  options.lidar_topic = "/front";

  EXPECT_EQ(import(options).points, 10U);

  options.lidar_topic = "/absent";
  EXPECT_THROW(import_bag(folder_ / "in.bag", folder_ / "out", options, kQuiet), cli::UsageError);
}

TEST_F(BagImportTest, SaysWhatIsWrongWithABag) {
  add("/imu", "sensor_msgs/Imu", imu_message(5, 0, 9.81));
  EXPECT_THROW(import(), recording::RecordingError);

  write("broken.bag", "#ROSBAG V2.0\nnothing else");
  EXPECT_THROW(BagReader(folder_ / "broken.bag"), recording::RecordingError);
  write("other.bag", "no bag");
  EXPECT_THROW(BagReader(folder_ / "other.bag"), recording::RecordingError);
}

}  // namespace
}  // namespace slamd::importing
