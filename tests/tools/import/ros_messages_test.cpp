#include "tools/import/ros_messages.hpp"

#include <gtest/gtest.h>

#include <random>

#include "ros_bytes.hpp"

namespace slamd::importing {
namespace {

using Bytes = std::vector<std::byte>;

TEST(RosMessages, ReadsImu) {
  const auto sample = parse_imu(imu_message(1'700'000'000, 123'456'789, 9.81));

  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(sample->angular_rate_radps, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(sample->specific_force_mps2, Eigen::Vector3d(0.0, 0.5, 9.81));
}

TEST(RosMessages, ReadsPointCloud2) {
  const Bytes bytes = cloud_message(1'700'000'000, 10);

  const auto message = parse_point_cloud2(bytes);

  ASSERT_TRUE(message);
  EXPECT_EQ(message->cloud.points, 10U);
  EXPECT_EQ(message->cloud.number(*message->cloud.find("x"), 9), 10.0);
  EXPECT_EQ(message->cloud.integer(*message->cloud.find("ring"), 9), 9);
  EXPECT_NEAR(message->cloud.number(*message->cloud.find("time"), 0), -0.09, 1e-6);
}

TEST(RosMessages, ReadsLivoxCustomMsg) {
  const Bytes bytes = livox_message(1'700'000'000, 7);

  const auto message = parse_livox_custom(bytes);

  ASSERT_TRUE(message);
  EXPECT_EQ(message->stamp.time_since_epoch().count(), 1'700'000'000'000'000'005);
  EXPECT_EQ(message->cloud.points, 7U);
  EXPECT_EQ(message->cloud.integer(*message->cloud.find("offset_time_ns"), 6), 60'000'000);
  EXPECT_EQ(message->cloud.integer(*message->cloud.find("line"), 5), 5);
  EXPECT_EQ(message->cloud.integer(*message->cloud.find("tag"), 5), 0x10);
}

TEST(RosMessages, ReadsVelodyneScan) {
  std::vector<Stamp> stamps;

  ASSERT_TRUE(parse_velodyne_scan(velodyne_message(5, 3, 0x22), [&](Stamp stamp, auto payload) {
    stamps.push_back(stamp);
    EXPECT_EQ(payload.size(), 1206U);
    EXPECT_EQ(payload[1205], std::byte{0x22});
  }));

  ASSERT_EQ(stamps.size(), 3U);
  EXPECT_EQ(stamps[2].time_since_epoch().count(), 5'002'000'000);
}

TEST(RosMessages, RefusesEveryTruncation) {
  const auto cut_everywhere = [](const Bytes& whole, auto&& is_refused) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      ASSERT_TRUE(is_refused(std::span(whole).first(size))) << size;
    }
  };

  cut_everywhere(imu_message(1, 1, 9.81), [](auto bytes) { return !parse_imu(bytes); });
  cut_everywhere(cloud_message(1, 3), [](auto bytes) { return !parse_point_cloud2(bytes); });
  cut_everywhere(livox_message(1, 3), [](auto bytes) { return !parse_livox_custom(bytes); });
  cut_everywhere(velodyne_message(1, 2, 0x22), [](auto bytes) {
    return !parse_velodyne_scan(bytes, [](Stamp, auto) { FAIL(); });
  });
}

TEST(RosMessages, SurvivesMutations) {
  std::mt19937 random(11);
  const Bytes files[] = {imu_message(1, 1, 9.81),
                         cloud_message(1, 3),
                         livox_message(1, 3),
                         velodyne_message(1, 1, 0x22)};
  double sum = 0.0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = files[round % 4];
    for (std::size_t i = 0; i <= random() % 3; ++i) {
      bytes[random() % std::min<std::size_t>(bytes.size(), 200)] = static_cast<std::byte>(random());
    }
    parse_imu(bytes);
    parse_velodyne_scan(bytes, [](Stamp, auto) {});
    for (const auto& message : {parse_point_cloud2(bytes), parse_livox_custom(bytes)}) {
      for (std::size_t i = 0; message && i < message->cloud.columns.size(); ++i) {
        const clouds::RawCloud& cloud = message->cloud;
        sum += cloud.points > 0 ? cloud.number(cloud.columns[i], cloud.points - 1) : 0.0;
      }
    }
  }
  EXPECT_NE(sum, 0.0);
}

}  // namespace
}  // namespace slamd::importing
