#include "daemon/stages/packet_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "core/base/bytes.hpp"
#include "drivers/livox/sdk2_header.hpp"

namespace slamd::stages {
namespace {

using configuration::Configuration;
using configuration::LidarModel;

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
constexpr int kPointPort = 56301;
constexpr int kImuPort = 56401;

/// A Mid-360 that stands still and sees one point, 1 m ahead.
class Mid360PacketStage : public testing::Test {
 protected:
  Mid360PacketStage() {
    configuration_.lidar.model = LidarModel::kLivoxMid360;
    configuration_.imu.enabled = true;
    configuration_.imu.source = "livox";
  }

  PacketOutcome add(PacketStage& stage, std::uint8_t data_type, int port, std::uint16_t number) {
    const bool inertial = data_type == 0;
    payload_.assign(inertial ? 60 : 1380, std::byte{0});
    if (inertial) {
      store_le(payload_, 36 + 20, 1.0F);
    } else {
      store_le(payload_, 36, std::int32_t{1000});
    }
    livox::Sdk2Header header;
    header.data_type = data_type;
    header.points = inertial ? 1 : 96;
    header.time_interval_100ns = 4750;
    header.number = number;
    header.timestamp_ns = std::uint64_t{480'000} * number;
    livox::seal_sdk2_packet(header, payload_);
    recording::Packet packet;
    packet.received = kBegin + Duration(480'000) * number;
    packet.destination_port = static_cast<std::uint16_t>(port);
    packet.payload = payload_;
    return stage.add(packet, *block_);
  }

  static std::uint64_t count_of(const PacketStage& stage, const std::string& name) {
    const NamedCounts counts = stage.packets();
    const auto found = std::find_if(counts.begin(), counts.end(), [&](const auto& entry) { return entry.first == name; });
    return found == counts.end() ? 0 : found->second;
  }

  Configuration configuration_;
  std::vector<std::byte> payload_;
  std::unique_ptr<sensor::PointBlock> block_ = std::make_unique<sensor::PointBlock>();
};

TEST_F(Mid360PacketStage, GivesPointsAndInertialSamplesOnOneTimeBase) {
  PacketStage sut(configuration_);

  const PacketOutcome points = add(sut, 1, kPointPort, 1);
  const PacketOutcome inertial = add(sut, 0, kImuPort, 1);

  ASSERT_TRUE(points.has_block);
  EXPECT_EQ(block_->points.size(), 1U);
  EXPECT_EQ(block_->points[0].x_m, 1.0F);
  ASSERT_TRUE(inertial.imu);
  EXPECT_NEAR(inertial.imu->specific_force_mps2.z(), 9.80665, 1e-6);
  EXPECT_LT(std::abs((inertial.imu->stamp - block_->stamp).count()), 1'000'000);
  EXPECT_EQ(count_of(sut, "points"), 1U);
  EXPECT_EQ(count_of(sut, "imu"), 1U);
}

TEST_F(Mid360PacketStage, TakesItsTwoPortsAndCountsAllOthersAsForeign) {
  configuration_.lidar.port = 57000;
  configuration_.lidar.imu_port = 58000;
  PacketStage sut(configuration_);

  EXPECT_TRUE(add(sut, 1, 57000, 1).has_block);
  EXPECT_TRUE(add(sut, 0, 58000, 1).imu);
  EXPECT_FALSE(add(sut, 1, kPointPort, 2).has_block);

  EXPECT_EQ(count_of(sut, "foreign_port"), 1U);
}

TEST_F(Mid360PacketStage, NamesWhatItRefusesAndSaysWhatIsMissing) {
  PacketStage sut(configuration_);

  add(sut, 1, kPointPort, 1);
  add(sut, 1, kPointPort, 5);
  add(sut, 4, kPointPort, 6);

  EXPECT_EQ(count_of(sut, "refused_unknown_data_type"), 1U);
  ASSERT_FALSE(sut.remarks().empty());
  EXPECT_EQ(sut.remarks()[0], "by their own numbers, 3 packets of points and 0 of the inertial sensor are missing");
}

TEST(AviaPacketStage, KeepsItsTimeWhileItsStampsCountFromEachPpsEdge) {
  Configuration configuration;
  configuration.lidar.model = LidarModel::kLivoxAvia;
  configuration.imu.enabled = true;
  configuration.imu.source = "livox";
  PacketStage sut(configuration);
  const auto block = std::make_unique<sensor::PointBlock>();
  std::vector<std::byte> payload(42, std::byte{0});
  payload[0] = std::byte{5};
  payload[8] = std::byte{4};
  payload[9] = std::byte{6};
  store_le(payload, 18 + 20, 1.0F);
  recording::Packet packet;
  packet.destination_port = 56001;
  packet.payload = payload;

  for (int i = 0; i < 1000; ++i) {
    packet.received = kBegin + std::chrono::milliseconds(5 * i);
    store_le(payload, 10, std::uint64_t{1'000'000} * static_cast<unsigned>((700 + 5 * i) % 1000));
    const PacketOutcome outcome = sut.add(packet, *block);

    ASSERT_TRUE(outcome.imu) << i;
    EXPECT_LT(std::abs((outcome.imu->stamp - packet.received).count()), 1000) << i;
  }
  EXPECT_EQ(sut.clock().steps, 0U);
  EXPECT_EQ(sut.clock().roll_overs, 5U);
}

}  // namespace
}  // namespace slamd::stages
