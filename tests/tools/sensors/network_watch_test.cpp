#include "tools/sensors/network_watch.hpp"

#include <random>

#include <gtest/gtest.h>

#include "made_bytes.hpp"
#include "tests/hex/hex.hpp"

namespace slamd::sensors {
namespace {

using configuration::LidarModel;

class NetworkWatchTest : public testing::Test {
 protected:
  bool take(const Bytes& bytes, std::uint16_t port, std::uint32_t source = kSensor, Stamp received = kBegin) {
    return sut_.take(arrival_of(bytes, port, source, received), kInterfaces);
  }

  Seen seen(Stamp now = kBegin) const {
    Seen seen;
    sut_.show(now, seen);
    return seen;
  }

  NetworkWatch sut_;
};

TEST_F(NetworkWatchTest, FindsAnAviaByItsGoldenBroadcast) {
  EXPECT_TRUE(take(hex::from_hex("AA012200020000597E0000334A45444B3338303031305A333931000700009DBD7AD7"), 55000));
  sut_.end_second();

  const Seen found = seen(kBegin + std::chrono::seconds(2));
  ASSERT_EQ(found.lidars.size(), 1U);
  EXPECT_EQ(found.lidars[0].code, "3JEDK380010Z391");
  EXPECT_EQ(found.lidars[0].type, "Livox Avia");
  EXPECT_EQ(found.lidars[0].model, LidarModel::kLivoxAvia);
  EXPECT_EQ(found.lidars[0].address, kSensor);
  EXPECT_EQ(found.lidars[0].broadcasts, (Count{1, 1}));
  EXPECT_EQ(found.lidars[0].silent_s, 2.0);
}

TEST_F(NetworkWatchTest, NamesADeviceThatSlamdDoesNotRead) {
  take(sdk1_broadcast("0TFDG3B006H2Z11", 3), 55000);

  EXPECT_EQ(seen().lidars[0].type, "Livox Horizon");
  EXPECT_FALSE(seen().lidars[0].model);
}

TEST_F(NetworkWatchTest, FindsAMid360ByItsAnswerAndWhereItTakesQuestions) {
  EXPECT_TRUE(take(sdk2_answer("47MDL1234567890"), 56000));

  EXPECT_EQ(seen().lidars[0].model, LidarModel::kLivoxMid360);
  EXPECT_EQ(seen().lidars[0].code, "47MDL1234567890");
  ASSERT_EQ(sut_.sdk2_devices().size(), 1U);
  EXPECT_EQ(sut_.sdk2_devices()[0], (livox::Endpoint{kSensor, 56100}));
}

TEST_F(NetworkWatchTest, ReadsWhereAMid360SendsTo) {
  take(sdk2_answer("47MDL1234567890"), 56000);

  EXPECT_TRUE(take(sdk2_state(0xC0A80105, 1), 56000));

  EXPECT_EQ(seen().lidars[0].sends_to, 0xC0A80105U);
  EXPECT_EQ(seen().lidars[0].time, TimeSource::kPtp);
}

TEST_F(NetworkWatchTest, CountsRowsOfCsv) {
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(take(text_bytes(std::to_string(10'000'000 * i) + ",0,0,0,0,0,9.81\n"), 7501));
  }
  EXPECT_FALSE(take(text_bytes("0,0,0,0,0,0,nine\n"), 7501));
  sut_.end_second();

  ASSERT_EQ(seen().rows.size(), 1U);
  EXPECT_EQ(seen().rows[0].address, kSensor);
  EXPECT_EQ(seen().rows[0].port, 7501);
  EXPECT_EQ(seen().rows[0].imu.samples, (Count{50, 50}));
  EXPECT_EQ(seen().rows[0].imu.refused, 1U);
  EXPECT_TRUE(seen().lidars.empty());
}

TEST_F(NetworkWatchTest, TellsAnotherHostsSearchFromItsOwn) {
  const Bytes search = bytes_of(livox::write_sdk2_frame({1, livox::Sdk2Command::kDiscovery, false, false, {}}));

  EXPECT_TRUE(take(search, 56000, kHost));
  EXPECT_TRUE(take(search, 56000, 0x0A4D0063));
  EXPECT_TRUE(take(search, 56000, 0x0A4D0063));

  EXPECT_EQ(seen().searchers, std::vector<std::uint32_t>{0x0A4D0063});
}

TEST_F(NetworkWatchTest, CountsPacketsOfAVelodyneAndKnowsItsModel) {
  EXPECT_TRUE(take(velodyne_packet(0x28), 2368));
  EXPECT_TRUE(take(velodyne_packet(0x28), 2368));
  EXPECT_TRUE(take(position_packet(2, "$GPRMC,1"), 8308));
  sut_.end_second();

  const LidarSeen found = seen().lidars.at(0);
  EXPECT_EQ(found.model, LidarModel::kVlp32c);
  EXPECT_EQ(found.packets, (Count{2, 2}));
  EXPECT_EQ(found.positions, (Count{1, 1}));
  EXPECT_EQ(found.pps, velodyne::PpsState::kLocked);
  EXPECT_EQ(found.sentence, "$GPRMC,1");
  EXPECT_EQ(found.port, 2368);
}

TEST_F(NetworkWatchTest, CountsSamplesOfAnAviaAndReadsItsStatus) {
  constexpr std::uint32_t kPpsPresent = 1U << 12U;
  for (std::uint32_t i = 0; i < 200; ++i) {
    EXPECT_TRUE(take(sdk1_sample(kPpsPresent, std::uint64_t{5'000'000} * i), 56001));
  }
  sut_.end_second();

  const LidarSeen found = seen().lidars.at(0);
  ASSERT_TRUE(found.imu);
  EXPECT_EQ(found.imu->samples, (Count{200, 200}));
  EXPECT_TRUE(found.imu->shows_gravity());
  EXPECT_EQ(found.time, TimeSource::kFreeRunning);
  ASSERT_TRUE(found.status);
  EXPECT_EQ(found.status->pps_present, livox::parse_status_code(kPpsPresent).pps_present);
}

TEST_F(NetworkWatchTest, CountsSamplesOfAMid360) {
  for (std::uint16_t i = 0; i < 200; ++i) {
    EXPECT_TRUE(take(sdk2_sample(2, i), 56401));
  }

  EXPECT_EQ(seen().lidars.at(0).imu->samples.total, 200U);
  EXPECT_EQ(seen().lidars.at(0).time, TimeSource::kGps);
}

TEST_F(NetworkWatchTest, TellsSensorsOfOneAddressApart) {
  take(velodyne_packet(), 2368);
  take(sdk1_broadcast("3JEDK380010Z391"), 55000);
  take(sdk2_answer("47MDL1234567890"), 56000);
  take(velodyne_packet(), 2368);

  EXPECT_EQ(seen().lidars.size(), 3U);
  EXPECT_EQ(seen().lidars[0].packets.total, 2U);
}

TEST_F(NetworkWatchTest, AddsOnlyWhatIsNotSeenYet) {
  take(sdk1_broadcast("3JEDK380010Z391"), 55000);
  take(sdk1_broadcast("3JEDK380010Z392"), 55000, 0xC0A80132);
  Seen seen;
  seen.lidars = {this->seen().lidars[0]};

  sut_.show(kBegin, seen);

  ASSERT_EQ(seen.lidars.size(), 2U);
  EXPECT_EQ(seen.lidars[1].address, 0xC0A80132U);
}

TEST_F(NetworkWatchTest, TakesNothingFromStrangers) {
  EXPECT_FALSE(take({}, 2368));
  EXPECT_FALSE(take(text_bytes("hello"), 2368));
  EXPECT_FALSE(take(Bytes(1206), 2368));
  Bytes damaged = sdk1_broadcast("3JEDK380010Z391");
  damaged.back() ^= std::byte{1};
  EXPECT_FALSE(take(damaged, 55000));

  EXPECT_TRUE(seen().lidars.empty());
}

TEST_F(NetworkWatchTest, CountsWhatIsDamagedOfASensorThatItKnows) {
  take(velodyne_packet(), 2368);

  EXPECT_FALSE(take(Bytes(1206), 2368));

  EXPECT_EQ(seen().lidars[0].refused, 1U);
}

TEST_F(NetworkWatchTest, KeepsAccountOfSoManySensorsAndCountsTheRest) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    take(sdk1_broadcast("CODE" + std::to_string(i)), 55000, kSensor + i);
  }

  EXPECT_EQ(seen().lidars.size(), NetworkWatch::kMostSensors);
  EXPECT_EQ(seen().left_out, 1000U - NetworkWatch::kMostSensors);
}

TEST_F(NetworkWatchTest, ShowsNoControlCharactersOfADevicesName) {
  take(sdk1_broadcast("\033[2J\n\"evil"), 55000);

  const std::string code = seen().lidars.at(0).code;
  EXPECT_EQ(code, "?[2J?\"evil");
}

TEST_F(NetworkWatchTest, SurvivesDamageInEveryKindOfDatagram) {
  std::mt19937 random(11);
  const std::vector<Bytes> good{sdk1_broadcast("3JEDK380010Z391"), sdk2_answer("47MDL1234567890"), sdk2_state(kHost, 0),
                                sdk1_sample(0, 1), sdk2_sample(0, 1), velodyne_packet(), position_packet(1, "$GPRMC")};
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = good[random() % good.size()];
    for (int j = 0; j < 3; ++j) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }
    bytes.resize(random() % 4 == 0 ? random() % bytes.size() : bytes.size());
    take(bytes, 2368, kSensor + random() % 3);
  }

  EXPECT_LE(seen().lidars.size(), NetworkWatch::kMostSensors);
}

}  // namespace
}  // namespace slamd::sensors
