#include "daemon/bus/encoding.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/odometry/odometry.hpp"
#include "tests/daemon/bus/made_messages.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::bus {
namespace {

template <typename Message>
std::vector<std::byte> encoded(const Message& message) {
  std::vector<std::byte> bytes(kLargestMessage_bytes);
  bytes.resize(encode(message, bytes));
  return bytes;
}

ScanChunk made_chunk() {
  ScanChunk chunk;
  chunk.scan_index = 42;
  chunk.stamp = Stamp(Duration(1'700'000'000'000'000'000));
  chunk.index = 1;
  chunk.count = 2;
  chunk.scan_crc32 = 0xDEADBEEF;
  chunk.T_odom_base = geometry::Se3(Eigen::Matrix3d::Identity(), {1.0, 2.0, 3.0});
  chunk.origin_odom = {1.0, 2.0, 3.0};
  chunk.points_cm = {{1, -2, 300}, {-32767, 32767, 0}};
  return chunk;
}

/// From n bytes at offset on.
std::vector<int> bytes_at(const std::vector<std::byte>& message, std::size_t offset, std::size_t n) {
  std::vector<int> result;
  for (std::size_t i = offset; i < offset + n; ++i) {
    result.push_back(std::to_integer<int>(message.at(i)));
  }
  return result;
}

using Bytes = std::vector<int>;

TEST(Encoding, OfAPoseIsThisSequenceOfBytes) {
  const auto message = encoded(made_pose());

  ASSERT_EQ(message.size(), 247U);
  // After the fingerprint of 8 bytes, all numbers big-endian, as docs/protocol.md lists them.
  EXPECT_EQ(bytes_at(message, 8, 8), (Bytes{0x17, 0x97, 0x9C, 0xFE, 0x3D, 0x85, 0xCD, 0x15}));   // 1700000000123456789
  EXPECT_EQ(bytes_at(message, 16, 8), (Bytes{0, 0, 0, 0, 0, 0x03, 0xD0, 0x90}));                 // 250000
  EXPECT_EQ(bytes_at(message, 24, 8), (Bytes{0x3F, 0xF0, 0, 0, 0, 0, 0, 0}));                    // x = 1.0
  EXPECT_EQ(bytes_at(message, 32, 8), (Bytes{0xC0, 0x00, 0, 0, 0, 0, 0, 0}));                    // y = -2.0
  EXPECT_EQ(bytes_at(message, 40, 8), (Bytes{0x3F, 0xE0, 0, 0, 0, 0, 0, 0}));                    // z = 0.5
  EXPECT_NEAR(load_be<double>(message, 48), 0.0, 1e-12);                                         // quaternion x
  EXPECT_NEAR(load_be<double>(message, 56), 0.6, 1e-12);                                         // y
  EXPECT_NEAR(load_be<double>(message, 64), 0.0, 1e-12);                                         // z
  EXPECT_NEAR(load_be<double>(message, 72), 0.8, 1e-12);                                         // w
  EXPECT_EQ(bytes_at(message, 80, 8), (Bytes{0x40, 0x08, 0, 0, 0, 0, 0, 0}));                    // v x = 3.0
  EXPECT_EQ(bytes_at(message, 120, 8), (Bytes{0xBF, 0xF0, 0, 0, 0, 0, 0, 0}));                   // rate z = -1.0
  EXPECT_EQ(bytes_at(message, 128, 8), (Bytes{0, 0, 0, 0, 0x3F, 0x80, 0, 0}));                   // P(0,0), P(0,1) = 1
  EXPECT_EQ(bytes_at(message, 152, 4), (Bytes{0x41, 0x30, 0, 0}));                               // P(1,1) = 11
  EXPECT_EQ(bytes_at(message, 208, 4), (Bytes{0x42, 0x5C, 0, 0}));                               // P(5,5) = 55
  EXPECT_EQ(bytes_at(message, 212, 8), (Bytes{0x3F, 0x80, 0, 0, 0x3F, 0x00, 0, 0}));             // velocity: 1, 0.5
  EXPECT_EQ(bytes_at(message, 236, 8), (Bytes{0, 0, 0, 7, 0, 0, 0, 9}));                         // counter, correction
  EXPECT_EQ(bytes_at(message, 244, 3), (Bytes{2, 7, 5}));                                        // state, cause, axes
}

TEST(Encoding, GivesThePoseBack) {
  const Pose pose = made_pose();

  const auto again = decode_pose(encoded(pose));

  ASSERT_TRUE(again);
  EXPECT_EQ(again->stamp, pose.stamp);
  EXPECT_EQ(again->age, pose.age);
  EXPECT_EQ(again->T_odom_base.translation(), pose.T_odom_base.translation());
  EXPECT_LT((again->T_odom_base.rotation() - pose.T_odom_base.rotation()).norm(), 1e-12);
  EXPECT_EQ(again->v_odom_base, pose.v_odom_base);
  EXPECT_EQ(again->rate_base_radps, pose.rate_base_radps);
  EXPECT_EQ(again->P_odom_base, pose.P_odom_base);
  EXPECT_EQ(again->P_velocity_odom, pose.P_velocity_odom);
  EXPECT_EQ(again->reset_counter, pose.reset_counter);
  EXPECT_EQ(again->correction_id, pose.correction_id);
  EXPECT_EQ(again->state, pose.state);
  EXPECT_EQ(again->cause, pose.cause);
  EXPECT_EQ(again->weak_axes, pose.weak_axes);
}

TEST(Encoding, GivesTheMapToOdomBack) {
  const MapToOdom sent{.stamp = Stamp(Duration(5)),
                       .T_map_odom = geometry::Se3(Eigen::Quaterniond(0.6, 0.0, 0.0, 0.8), Eigen::Vector3d(1, 2, 3)),
                       .correction_id = 4,
                       .cause = Correction::kCommand};

  const auto again = decode_map_to_odom(encoded(sent));

  ASSERT_TRUE(again);
  EXPECT_EQ(again->stamp, sent.stamp);
  EXPECT_EQ(again->T_map_odom.translation(), sent.T_map_odom.translation());
  EXPECT_LT((again->T_map_odom.rotation() - sent.T_map_odom.rotation()).norm(), 1e-12);
  EXPECT_EQ(again->correction_id, 4U);
  EXPECT_EQ(again->cause, Correction::kCommand);
}

SubmapPoses made_submap_poses() {
  SubmapPoses submap_poses{.stamp = Stamp(Duration(7)), .correction_id = 3, .epoch = 2, .index = 1, .count = 2, .submaps = {}, .size = 2};
  submap_poses.submaps[1] = {.id = 19,
                             .version = 5,
                             .anchor_odom = {1.6, -3.2, 0.0},
                             .T_map_submap = geometry::Se3(Eigen::Quaterniond(0.6, 0.0, 0.0, 0.8), Eigen::Vector3d(1, 2, 3))};
  return submap_poses;
}

TEST(Encoding, GivesSubmapPosesBack) {
  const SubmapPoses sent = made_submap_poses();

  const auto again = decode_submap_poses(encoded(sent));

  ASSERT_TRUE(again);
  EXPECT_EQ(again->stamp, sent.stamp);
  EXPECT_EQ(again->correction_id, 3U);
  EXPECT_EQ(again->epoch, 2U);
  EXPECT_EQ(again->index, 1U);
  ASSERT_EQ(again->size, 2U);
  EXPECT_EQ(again->submaps[1].id, 19U);
  EXPECT_EQ(again->submaps[1].version, 5U);
  EXPECT_EQ(again->submaps[1].anchor_odom, sent.submaps[1].anchor_odom);
  EXPECT_EQ(again->submaps[1].T_map_submap.translation(), sent.submaps[1].T_map_submap.translation());
  EXPECT_LT((again->submaps[1].T_map_submap.rotation() - sent.submaps[1].T_map_submap.rotation()).norm(), 1e-6);
}

TEST(Decoding, RefusesSubmapPosesThatAreNotFullButForTheLastChunk) {
  SubmapPoses submap_poses = made_submap_poses();
  submap_poses.index = 0;

  EXPECT_FALSE(decode_submap_poses(encoded(submap_poses)));
}

TEST(Encoding, OfAChunkIsThisSequenceOfBytes) {
  const auto message = encoded(made_chunk());

  ASSERT_EQ(message.size(), 1314U);
  EXPECT_EQ(bytes_at(message, 8, 8), (Bytes{0, 0, 0, 0, 0, 0, 0, 42}));
  EXPECT_EQ(bytes_at(message, 24, 4), (Bytes{0, 1, 0, 2}));                                   // chunk 1 of 2
  EXPECT_EQ(bytes_at(message, 28, 4), (Bytes{0xDE, 0xAD, 0xBE, 0xEF}));                       // CRC
  EXPECT_EQ(bytes_at(message, 112, 2), (Bytes{0, 2}));                                        // points
  EXPECT_EQ(bytes_at(message, 114, 6), (Bytes{0x00, 0x01, 0xFF, 0xFE, 0x01, 0x2C}));          // 1, -2, 300 cm
  EXPECT_EQ(bytes_at(message, 120, 6), (Bytes{0x80, 0x01, 0x7F, 0xFF, 0x00, 0x00}));
  EXPECT_EQ(bytes_at(message, 126, 6), (Bytes{0, 0, 0, 0, 0, 0}));
}

TEST(Encoding, GivesTheChunkBack) {
  const ScanChunk chunk = made_chunk();

  const auto again = decode_scan_chunk(encoded(chunk));

  ASSERT_TRUE(again);
  EXPECT_EQ(again->scan_index, 42U);
  EXPECT_EQ(again->stamp, chunk.stamp);
  EXPECT_EQ(again->index, 1);
  EXPECT_EQ(again->count, 2);
  EXPECT_EQ(again->scan_crc32, 0xDEADBEEFU);
  EXPECT_EQ(again->T_odom_base.translation(), chunk.T_odom_base.translation());
  EXPECT_EQ(again->origin_odom, chunk.origin_odom);
  ASSERT_EQ(again->points_cm.size(), 2U);
  EXPECT_EQ(again->points_cm[1], chunk.points_cm[1]);
}

TEST(Encoding, OfTheFullestHealthFitsOneMessage) {
  const auto message = encoded(full_health());

  EXPECT_GT(message.size(), 1000U);
  EXPECT_LE(message.size(), kLargestMessage_bytes);
}

TEST(Encoding, GivesTheHealthBack) {
  const Health health = full_health();

  const auto again = decode_health(encoded(health));

  ASSERT_TRUE(again);
  EXPECT_EQ(again->stamp, health.stamp);
  EXPECT_EQ(again->uptime, health.uptime);
  EXPECT_EQ(again->state, health.state);
  EXPECT_EQ(again->weak_axes, 3);
  EXPECT_EQ(again->swarm_use, 0.25F);
  EXPECT_EQ(again->particles, 64U);
  EXPECT_EQ(again->inlier_share, 0.75F);
  ASSERT_EQ(again->causes.size(), health.causes.capacity());
  EXPECT_EQ(again->causes.back().view(), std::string(79, 'c'));
  ASSERT_EQ(again->sensors.size(), health.sensors.capacity());
  EXPECT_EQ(again->sensors.back().name.view(), std::string(15, 's'));
  EXPECT_EQ(again->sensors.back().state, SensorState::kSilent);
  EXPECT_EQ(again->sensors.back().time, TimeState::kLocked);
  EXPECT_EQ(again->sensors.back().rate_hz, 10.5F);
  EXPECT_EQ(again->sensors.back().received, 1'000'000'000'000U);
  EXPECT_EQ(again->sensors.back().lost, 2U);
  EXPECT_EQ(again->sensors.back().dropped, 3U);
  EXPECT_EQ(again->sensors.back().time_residual_us, 40.0F);
  EXPECT_EQ(again->sensors.back().time_skew_ppm, -12.0F);
  EXPECT_EQ(again->sensors.back().time_steps, 5U);
  EXPECT_EQ(again->imu_offset_ms, -2.5F);
  EXPECT_EQ(again->imu_offset_std_ms, 0.25F);
  ASSERT_EQ(again->stages.size(), health.stages.capacity());
  EXPECT_EQ(again->stages.back().p50_us, 1.0F);
  EXPECT_EQ(again->stages.back().p99_us, 2.0F);
  EXPECT_EQ(again->stages.back().max_us, 3.0F);
  EXPECT_EQ(again->stages.back().count, 4U);
  ASSERT_EQ(again->pools.size(), health.pools.capacity());
  EXPECT_EQ(again->pools.back().capacity, 8U);
  EXPECT_EQ(again->pools.back().low_water, 6U);
  ASSERT_EQ(again->counters.size(), health.counters.capacity());
  EXPECT_EQ(again->counters.back().value, 1'000'000'000'001U);
}

TEST(Encoding, GivesCommandAndReplyBack) {
  const auto command = decode_command(encoded(Command{.id = ~0ULL, .verb = "save", .arguments = {"my map.slamd"}}));
  const auto reply = decode_reply(encoded(Reply{.id = 3, .ok = true, .text = "saved"}));

  ASSERT_TRUE(command && reply);
  EXPECT_EQ(command->id, ~0ULL);
  EXPECT_EQ(command->verb, "save");
  EXPECT_EQ(command->arguments, std::vector<std::string>{"my map.slamd"});
  EXPECT_EQ(reply->id, 3U);
  EXPECT_TRUE(reply->ok);
  EXPECT_EQ(reply->text, "saved");
}

TEST(Encoding, CutsAReplyThatIsTooLong) {
  const auto reply = decode_reply(encoded(Reply{.id = 3, .ok = true, .text = std::string(5000, 'x')}));

  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->text.size(), 1000U);
}

TEST(Encoding, OfACommandWithTooMuchInItIsNothing) {
  EXPECT_TRUE(encoded(Command{.id = 1, .verb = "save", .arguments = {std::string(2000, 'x')}}).empty());
  EXPECT_TRUE(encoded(Command{.id = 1, .verb = "save", .arguments = std::vector<std::string>(5)}).empty());
}

TEST(Encoding, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Pose pose = made_pose();
  const MapToOdom map_to_odom;
  const SubmapPoses submap_poses = made_submap_poses();
  const ScanChunk chunk = made_chunk();
  std::array<std::byte, kLargestMessage_bytes> buffer;

  std::size_t size = 0;
  const std::size_t count = support::count_allocations([&] {
    size += encode(pose, buffer);
    size += encode(map_to_odom, buffer);
    size += encode(submap_poses, buffer);
    size += encode(chunk, buffer);
  });

  EXPECT_GT(size, 1500U);
  EXPECT_EQ(count, 0U);
}

TEST(Decoding, RefusesAStateThatHasNoName) {
  auto message = encoded(made_pose());
  message[244] = std::byte{5};

  EXPECT_FALSE(decode_pose(message));
}

TEST(Decoding, RefusesAQuaternionThatIsNone) {
  auto message = encoded(made_pose());
  store_be(std::span<std::byte>(message), 72, 0.0);

  EXPECT_FALSE(decode_pose(message));
}

TEST(Decoding, RefusesAChunkThatIsNotFullButForTheLast) {
  ScanChunk chunk = made_chunk();
  chunk.index = 0;

  EXPECT_FALSE(decode_scan_chunk(encoded(chunk)));
}

TEST(Decoding, RefusesAStringOfImpossibleLength) {
  // The verb's length stands at 16; lcm-gen's own decoder would throw or overflow.
  for (const std::int32_t length : {0, -1, std::numeric_limits<std::int32_t>::min(), 2000}) {
    auto message = encoded(Command{.id = 1, .verb = "seal", .arguments = {}});
    ASSERT_TRUE(decode_command(message));

    store_be(std::span<std::byte>(message), 16, length);

    EXPECT_FALSE(decode_command(message)) << length;
  }
}

TEST(Decoding, RefusesWhatIsCutShortOrTooLong) {
  const std::vector<std::vector<std::byte>> messages{
      encoded(made_pose()), encoded(MapToOdom{}), encoded(made_submap_poses()), encoded(made_chunk()), encoded(full_health()),
      encoded(Command{.id = 1, .verb = "save", .arguments = {"x"}}), encoded(Reply{.id = 1, .ok = true, .text = "x"})};
  const auto any = [](std::span<const std::byte> bytes) {
    return decode_pose(bytes) || decode_map_to_odom(bytes) || decode_submap_poses(bytes) || decode_scan_chunk(bytes) || decode_health(bytes) ||
           decode_command(bytes) || decode_reply(bytes);
  };
  for (auto message : messages) {
    ASSERT_TRUE(any(message));

    for (std::size_t size = 0; size < message.size(); ++size) {
      EXPECT_FALSE(any({message.data(), size})) << size;
    }
    message.push_back(std::byte{0});
    EXPECT_FALSE(any(message));
  }
}

TEST(Decoding, SurvivesWhateverStandsInAMessage) {
  std::mt19937 engine(3);
  const std::vector<std::vector<std::byte>> messages{
      encoded(made_pose()), encoded(MapToOdom{}), encoded(made_submap_poses()), encoded(made_chunk()), encoded(full_health()),
      encoded(Command{.id = 1, .verb = "save", .arguments = {"x"}}), encoded(Reply{.id = 1, .ok = true, .text = "x"})};
  int understood = 0;
  for (int round = 0; round < 3000; ++round) {
    for (auto message : messages) {
      for (int change = 0; change < 4; ++change) {
        message[8 + engine() % (message.size() - 8)] = static_cast<std::byte>(engine());
      }

      understood += decode_pose(message) || decode_map_to_odom(message) || decode_submap_poses(message) || decode_scan_chunk(message) ||
                    decode_health(message) || decode_command(message) || decode_reply(message);
    }
  }

  EXPECT_GT(understood, 0);
  EXPECT_LT(understood, 7 * 3000);
}

TEST(Encoding, OfAVelocityCommandIsThisSequenceOfBytes) {
  const auto message =
      encoded(VelocityCommand{.stamp = Stamp(Duration(1'700'000'000'123'456'789)), .v_mps = 1.0, .w_radps = -0.5});

  ASSERT_EQ(message.size(), 32U);
  EXPECT_EQ(bytes_at(message, 8, 8), (Bytes{0x17, 0x97, 0x9C, 0xFE, 0x3D, 0x85, 0xCD, 0x15}));
  EXPECT_EQ(bytes_at(message, 16, 8), (Bytes{0x3F, 0xF0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bytes_at(message, 24, 8), (Bytes{0xBF, 0xE0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(decode_velocity_command(message).value().w_radps, -0.5);
}

TEST(Encoding, RefusesAVelocityThatIsNoNumber) {
  EXPECT_FALSE(decode_velocity_command(encoded(VelocityCommand{.v_mps = std::nan("")})));
  EXPECT_FALSE(decode_velocity_command(encoded(VelocityCommand{.w_radps = INFINITY})));
  EXPECT_FALSE(decode_velocity_command(encoded(MapToOdom{})));
}

TEST(Encoding, GivesTheTruthBack) {
  const Truth sent{.stamp = Stamp(Duration(5)),
                   .T_world_base = geometry::Se3(Eigen::Quaterniond(0.6, 0.0, 0.0, 0.8), Eigen::Vector3d(1, 2, 3)),
                   .v_world_base = {4, 5, 6},
                   .rate_base_radps = {7, 8, 9},
                   .collisions = 10};

  const auto message = encoded(sent);
  const auto again = decode_truth(message);

  EXPECT_EQ(message.size(), 124U);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->stamp, sent.stamp);
  EXPECT_EQ(again->T_world_base.translation(), sent.T_world_base.translation());
  EXPECT_LT((again->T_world_base.rotation() - sent.T_world_base.rotation()).norm(), 1e-12);
  EXPECT_EQ(again->v_world_base, sent.v_world_base);
  EXPECT_EQ(again->rate_base_radps, sent.rate_base_radps);
  EXPECT_EQ(again->collisions, 10U);
}

TEST(Names, CountAsTheOdometrysDo) {
  EXPECT_EQ(int(State::kStarting), int(odometry::State::kStarting));
  EXPECT_EQ(int(State::kTracking), int(odometry::State::kTracking));
  EXPECT_EQ(int(State::kDegraded), int(odometry::State::kDegraded));
  EXPECT_EQ(int(State::kLost), int(odometry::State::kLost));
  EXPECT_EQ(int(Cause::kNone), int(odometry::Cause::kNone));
  EXPECT_EQ(int(Cause::kAligning), int(odometry::Cause::kAligning));
  EXPECT_EQ(int(Cause::kNoImu), int(odometry::Cause::kNoImu));
  EXPECT_EQ(int(Cause::kImuGap), int(odometry::Cause::kImuGap));
  EXPECT_EQ(int(Cause::kFewConstraints), int(odometry::Cause::kFewConstraints));
  EXPECT_EQ(int(Cause::kFewInliers), int(odometry::Cause::kFewInliers));
  EXPECT_EQ(int(Cause::kLargeInnovation), int(odometry::Cause::kLargeInnovation));
  EXPECT_EQ(int(Cause::kDegenerate), int(odometry::Cause::kDegenerate));
  EXPECT_EQ(int(Cause::kSaturated), int(odometry::Cause::kSaturated));
  EXPECT_EQ(int(Cause::kUnconfirmed), int(odometry::Cause::kUnconfirmed));
  EXPECT_EQ(int(Cause::kMapRestarted), int(odometry::Cause::kMapRestarted));
  EXPECT_EQ(int(Cause::kNoLidar), int(odometry::Cause::kNoLidar));
}

// What LCM makes of a datagram that is cut inside its channel's name.
TEST(Encoding, DoesNotBelieveASizeThatNoMessageHas) {
  std::vector<std::byte> bytes(kLargestMessage_bytes, std::byte{0x7F});
  const std::span<const std::byte> lie(bytes.data(), 0xFFFFFFF0U);

  EXPECT_FALSE(decode_command(lie));
  EXPECT_FALSE(decode_reply(lie));
}

}  // namespace
}  // namespace slamd::bus
