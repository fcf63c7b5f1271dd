#include "drivers/livox/sdk2_host.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "host_wire.hpp"
#include "tests/hex/hex.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::livox {
namespace {

using hex::Bytes;
using hex::from_hex;

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kHost = 0xC0A80105;   // 192.168.1.5
constexpr std::uint32_t kOther = 0xC0A80109;  // 192.168.1.9
constexpr Endpoint kCommands{0xC0A80170, 56100};
constexpr Endpoint kDiscovery{0xC0A80170, 56000};
constexpr std::string_view kSerialNumber = "47MDL1234567890";

template <typename T>
Bytes le(T value) {
  Bytes bytes(sizeof value);
  store_le(bytes, 0, value);
  return bytes;
}

Bytes bytes_of(const Payload& payload) { return {payload.begin(), payload.end()}; }

/// A Mid-360 that does what the test wants. Source: livox-sdk2.md §3.
class ScriptedMid360 {
 public:
  ScriptedMid360() {
    values[Sdk2Key::kFirmware] = from_hex("0D120011");
    values[Sdk2Key::kAttitude] = bytes_of(Sdk1Extrinsic{{1.0F, -2.0F, 90.0F}, {100, -200, 300}}.bytes());
    values[Sdk2Key::kPointDestination] = bytes_of(Sdk2Destination{kHost, 56301, 56300}.bytes());
    values[Sdk2Key::kWorkState] = le<std::uint8_t>(2);
    values[Sdk2Key::kPowerUps] = le<std::uint32_t>(17);
    values[Sdk2Key::kSyncType] = le<std::uint8_t>(0);
    values[Sdk2Key::kTemperature] = le<std::int32_t>(4213);
    values[Sdk2Key::kHealth] = Bytes(32);
  }

  bool on = true;
  bool deaf_to_commands = false;
  bool obeys_work_mode = true;
  std::map<Sdk2Key, Bytes> values;
  std::map<Sdk2Key, std::uint8_t> refusals;
  std::vector<Sdk2Key> set;
  int discoveries = 0;
  int questions = 0;
  std::optional<std::uint64_t> time_ns;

  static Bytes frame(std::uint32_t sequence, Sdk2Command command, bool ack, std::span<const std::byte> payload) {
    const FrameBytes bytes = write_sdk2_frame({sequence, command, ack, true, payload});
    return {bytes.begin(), bytes.end()};
  }

  Bytes discovery_ack(std::uint32_t sequence) const {
    return frame(sequence, Sdk2Command::kDiscovery, true,
                 Sdk2Discovery{0, 9, DeviceCode::of(kSerialNumber), 0xC0A80170, 56100}.bytes().view());
  }

  Bytes push(std::vector<Sdk2Key> keys) const {
    Sdk2ValueWriter writer;
    for (const Sdk2Key key : keys) {
      writer.add(key, values.at(key));
    }
    return frame(77, Sdk2Command::kStatePush, false, writer.payload());
  }

  std::optional<Bytes> answer(std::span<const std::byte> datagram) {
    Sdk2Frame request;
    std::size_t size = 0;
    EXPECT_EQ(parse_sdk2_frame(datagram, request, size), FrameResult::kOk);
    EXPECT_FALSE(request.from_device);
    if (!on) {
      return std::nullopt;
    }
    if (request.command == Sdk2Command::kDiscovery) {
      ++discoveries;
      return discovery_ack(request.sequence);
    }
    if (deaf_to_commands) {
      return std::nullopt;
    }
    if (request.command == Sdk2Command::kGetParameters) {
      ++questions;
      return frame(request.sequence, request.command, true, answer_to_question(request).payload());
    }
    if (request.command == Sdk2Command::kGpsTime) {
      time_ns = Sdk2GpsTime::parse(request.payload)->utc_ns;
      return frame(request.sequence, request.command, true, one_byte(0).view());
    }
    return frame(request.sequence, request.command, true, take_settings(request));
  }

  std::uint8_t work_state() const { return std::to_integer<std::uint8_t>(values.at(Sdk2Key::kWorkState)[0]); }

 private:
  Sdk2ValueWriter answer_to_question(const Sdk2Frame& request) {
    Sdk2ValueWriter writer(0);
    for (std::size_t at = 4; at + 2 <= request.payload.size(); at += 2) {
      const auto key = static_cast<Sdk2Key>(load_le<std::uint16_t>(request.payload, at));
      writer.add(key, values.at(key));
    }
    return writer;
  }

  Bytes take_settings(const Sdk2Frame& request) {
    Sdk2ValueReader reader = Sdk2ValueReader::of_push(request.payload);
    Bytes result(3);
    Sdk2Value value;
    while (reader.next(value)) {
      set.push_back(value.key);
      if (refusals.count(value.key) != 0) {
        result[0] = static_cast<std::byte>(refusals[value.key]);
        store_le(result, 1, static_cast<std::uint16_t>(value.key));
        continue;
      }
      values[value.key] = Bytes(value.bytes.begin(), value.bytes.end());
      if (value.key == Sdk2Key::kWorkMode && obeys_work_mode) {
        values[Sdk2Key::kWorkState] = values[value.key];
      }
    }
    EXPECT_TRUE(reader.complete());
    return result;
  }
};

Sdk2HostConfig config() {
  Sdk2HostConfig config;
  config.interfaces.push_back({kHost, 0xFFFFFF00});
  return config;
}

class Sdk2HostTest : public HostWire<Sdk2Host, ScriptedMid360> {
 protected:
  Sdk2HostTest() : HostWire(Sdk2Host(config()), kCommands) {}

  void point_at(std::uint32_t address) {
    device_.values[Sdk2Key::kPointDestination] = bytes_of(Sdk2Destination{address, 56301, 56300}.bytes());
  }
};

TEST_F(Sdk2HostTest, AsksEverybodyOnceASecondAndSaysAfterFiveThatNobodyAnswers) {
  device_.on = false;
  std::size_t asked = 0;
  for (int i = 0; i < 200; ++i) {
    now_ += milliseconds{50};
    sut_.advance(now_, out_);
    asked += out_.datagrams.size();
    deliver();
  }

  EXPECT_EQ(asked, 10U);
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSearching);
  EXPECT_EQ(told(HostEventKind::kNotSeen), 1U);
}

TEST_F(Sdk2HostTest, FindsReadsConfiguresAndStartsTheDevice) {
  Sdk2HostConfig with_pattern = config();
  with_pattern.scan_pattern = 0;
  sut_ = Sdk2Host(with_pattern);

  run(milliseconds{100});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
  EXPECT_EQ(sut_.serial_number().view(), kSerialNumber);
  EXPECT_EQ(sut_.device(), kCommands);
  EXPECT_EQ(device_.set, (std::vector{Sdk2Key::kStateDestination, Sdk2Key::kPointDestination, Sdk2Key::kImuDestination,
                                      Sdk2Key::kPointType, Sdk2Key::kScanPattern, Sdk2Key::kImuEnable,
                                      Sdk2Key::kPointSend, Sdk2Key::kWorkMode}));
  EXPECT_EQ(Sdk2Destination::parse(device_.values[Sdk2Key::kImuDestination]), (Sdk2Destination{kHost, 56401, 56400}));
  EXPECT_EQ(device_.values[Sdk2Key::kPointSend], Bytes{std::byte{0}});  // 0 sends
  EXPECT_EQ(device_.work_state(), 1);
  EXPECT_EQ(last_words(HostEventKind::kConnected), "47MDL1234567890 at 192.168.1.112 is connected");
  EXPECT_EQ(last_words(HostEventKind::kIdentified), "47MDL1234567890 has firmware 13.18.0.17");
  EXPECT_EQ(told(HostEventKind::kTakenOver), 0U);
  ASSERT_TRUE(sut_.attitude());
  EXPECT_EQ(sut_.attitude()->xyz_mm, (std::array<std::int32_t, 3>{100, -200, 300}));
  EXPECT_EQ(last_words(HostEventKind::kExtrinsicRead),
            "47MDL1234567890 has an extrinsic stored: xyz_m = [0.100, -0.200, 0.300], rpy_deg = [1, -2, 90]");
}

TEST_F(Sdk2HostTest, AsksForTheStateOnceASecond) {
  run(milliseconds{100});
  const int before = device_.questions;

  run(seconds{10});

  EXPECT_NEAR(device_.questions - before, 10, 1);
  EXPECT_NEAR(sut_.temperature_c().value_or(0.0), 42.13, 1e-9);
  EXPECT_EQ(told(HostEventKind::kSampling), 1U);
  EXPECT_EQ(told(HostEventKind::kLost), 0U);
}

TEST_F(Sdk2HostTest, WaitsWhileTheMotorStarts) {
  device_.obeys_work_mode = false;
  device_.values[Sdk2Key::kWorkState] = le<std::uint8_t>(6);
  run(seconds{5});
  EXPECT_EQ(sut_.state(), Sdk2HostState::kWaiting);
  EXPECT_EQ(std::count(device_.set.begin(), device_.set.end(), Sdk2Key::kWorkMode), 1);

  device_.values[Sdk2Key::kWorkState] = le<std::uint8_t>(1);
  give(device_.push({Sdk2Key::kWorkState}), {0xC0A80170, 56200});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, TellsAnIdleDeviceToSampleAgainOnceASecond) {
  device_.obeys_work_mode = false;
  run(seconds{5});

  const auto tries = std::count(device_.set.begin(), device_.set.end(), Sdk2Key::kWorkMode);
  EXPECT_GE(tries, 3);
  EXPECT_LE(tries, 6);
  device_.obeys_work_mode = true;
  run(seconds{2});
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, PutsTheDeviceToRestAndWakesItWhenTold) {
  run(milliseconds{100});

  sut_.set_sampling(false, now_, out_);
  deliver();
  EXPECT_EQ(sut_.state(), Sdk2HostState::kResting);
  EXPECT_EQ(device_.work_state(), 2);
  sut_.set_sampling(true, now_, out_);
  deliver();

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, SaysWhereTheDeviceSentToBefore) {
  point_at(kOther);

  run(milliseconds{100});

  EXPECT_EQ(last_words(HostEventKind::kTakenOver),
            "47MDL1234567890 sent to 192.168.1.9 until now; it sends to this host from now on");
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, LeavesADeviceToItsHostWhenItMayNotTakeIt) {
  Sdk2HostConfig polite = config();
  polite.take_over = false;
  sut_ = Sdk2Host(polite);
  point_at(kOther);
  run(seconds{5});
  EXPECT_EQ(sut_.state(), Sdk2HostState::kHeld);
  EXPECT_TRUE(device_.set.empty());
  EXPECT_EQ(told(HostEventKind::kHeldByOther), 1U);
  EXPECT_EQ(last_words(HostEventKind::kHeldByOther),
            "47MDL1234567890 is held by another host: it is set to send to 192.168.1.9; this one takes it back when it is "
            "set otherwise or restarts");

  point_at(0);
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, YieldsToAHostThatTakesTheDeviceAndTakesItBackWhenItRestarts) {
  run(seconds{1});
  const std::size_t before = device_.set.size();
  point_at(kOther);
  run(seconds{5});
  EXPECT_EQ(sut_.state(), Sdk2HostState::kHeld);
  EXPECT_EQ(told(HostEventKind::kHeldByOther), 1U);
  EXPECT_EQ(device_.set.size(), before);

  device_.values[Sdk2Key::kPowerUps] = le<std::uint32_t>(18);
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, ConfiguresADeviceAgainThatHasRestarted) {
  run(seconds{1});
  const std::size_t before = device_.set.size();
  device_.values[Sdk2Key::kPowerUps] = le<std::uint32_t>(18);
  device_.values[Sdk2Key::kWorkState] = le<std::uint8_t>(2);

  run(seconds{2});

  EXPECT_EQ(told(HostEventKind::kRestarted), 1U);
  EXPECT_EQ(device_.set.size(), before + 7);
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, NoticesSilenceAndFindsTheDeviceAgain) {
  run(seconds{1});
  device_.on = false;
  run(seconds{2});
  EXPECT_EQ(told(HostEventKind::kLost), 0U);
  run(seconds{2});
  EXPECT_EQ(told(HostEventKind::kLost), 1U);
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSearching);

  device_.on = true;
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, TakesAPushForASignOfLife) {
  run(seconds{1});
  device_.on = false;  // its answers get lost, its pushes do not

  for (int i = 0; i < 10; ++i) {
    run(seconds{1});
    give(device_.push({Sdk2Key::kWorkState}), {0xC0A80170, 56200});
  }

  EXPECT_EQ(told(HostEventKind::kLost), 0U);
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, SaysThatADeviceDoesNotAnswer) {
  device_.deaf_to_commands = true;

  run(milliseconds{3200});

  EXPECT_EQ(told(HostEventKind::kNoAnswer), 1U);
}

TEST_F(Sdk2HostTest, GoesOnWithoutASettingThatIsRefused) {
  device_.refusals[Sdk2Key::kImuEnable] = 0x20;

  run(milliseconds{100});

  EXPECT_EQ(last_words(HostEventKind::kCommandFailed),
            "47MDL1234567890 refuses with code 32: switch the inertial sensor");
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, DoesNotGoOnWithoutTheDestinations) {
  device_.refusals[Sdk2Key::kPointDestination] = 0x02;
  run(seconds{2});
  EXPECT_EQ(sut_.state(), Sdk2HostState::kConfiguring);

  device_.refusals.clear();
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, DoesNotTouchADeviceOfAnotherSubnetAndSaysSoOnce) {
  device_.on = false;
  for (std::uint32_t i = 0; i < 3; ++i) {
    give(device_.discovery_ack(i), {0xC0A80270, 56000});
  }

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSearching);
  EXPECT_EQ(told(HostEventKind::kWrongSubnet), 1U);
}

TEST_F(Sdk2HostTest, TakesOnlyTheDeviceThatItIsConfiguredFor) {
  Sdk2HostConfig other = config();
  other.serial_number = DeviceCode::of("47MDL0000000000");
  sut_ = Sdk2Host(other);

  run(seconds{3});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSearching);
  EXPECT_TRUE(device_.set.empty());
}

TEST_F(Sdk2HostTest, TellsOfSynchronisationAndHealthWhenTheyChange) {
  run(milliseconds{100});
  device_.values[Sdk2Key::kSyncType] = le<std::uint8_t>(1);
  device_.values[Sdk2Key::kHealth][4] = std::byte{0x2A};
  run(seconds{3});

  EXPECT_EQ(last_words(HostEventKind::kSyncChanged), "47MDL1234567890 is synchronised by ptp");
  EXPECT_EQ(last_words(HostEventKind::kHealthChanged), "47MDL1234567890 reports health code 42");
  EXPECT_EQ(told(HostEventKind::kHealthChanged), 1U);
  device_.values[Sdk2Key::kHealth][4] = std::byte{0};
  run(seconds{2});
  EXPECT_EQ(last_words(HostEventKind::kHealthChanged), "47MDL1234567890 is well");
}

TEST_F(Sdk2HostTest, TellsTheDeviceTheTimeOnceItIsConnected) {
  EXPECT_FALSE(sut_.set_gps_time(1, out_));
  run(milliseconds{100});

  EXPECT_TRUE(sut_.set_gps_time(1'795'327'324'000'000'000, out_));
  deliver();

  EXPECT_EQ(device_.time_ns, 1'795'327'324'000'000'000U);
  EXPECT_EQ(told(HostEventKind::kTimeSet), 1U);
}

TEST_F(Sdk2HostTest, StopsTheDeviceAndTakesItBack) {
  run(seconds{1});

  sut_.stop(out_);
  deliver();
  EXPECT_EQ(device_.work_state(), 2);
  run(seconds{3});
  EXPECT_EQ(sut_.state(), Sdk2HostState::kStopped);
  sut_.start();
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, CountsStrangersAndLateAnswersAndDoesNothing) {
  run(seconds{1});
  const std::uint64_t strangers = sut_.counters().strangers;
  const Bytes late = ScriptedMid360::frame(1, Sdk2Command::kSetParameters, true, Bytes(3));

  give(late, kCommands);
  give(late, {kOther, 56100});
  give(from_hex("AA0018000100000000000000000000000000A91F00000000"), {kOther, 56000});  // another host searches

  EXPECT_EQ(sut_.counters().unexpected, 1U);
  EXPECT_EQ(sut_.counters().strangers, strangers + 2);
  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, SurvivesAnyFramesAndStillReachesTheDevice) {
  std::mt19937 random(6);
  constexpr Sdk2Command kCommandsOfAll[] = {Sdk2Command::kDiscovery,     Sdk2Command::kSetParameters,
                                            Sdk2Command::kGetParameters, Sdk2Command::kStatePush,
                                            Sdk2Command::kGpsTime,       Sdk2Command::kReboot};
  for (int round = 0; round < 3000; ++round) {
    Bytes payload = round % 3 == 0 ? Bytes(random() % 60) : bytes_of(Sdk2Discovery{0, 9, {}, 0, 56100}.bytes());
    if (round % 5 == 0) {
      Sdk2Frame frame;
      std::size_t size = 0;
      const Bytes push = device_.push({Sdk2Key::kWorkState, Sdk2Key::kPowerUps, Sdk2Key::kPointDestination});
      ASSERT_EQ(parse_sdk2_frame(push, frame, size), FrameResult::kOk);
      payload.assign(frame.payload.begin(), frame.payload.end());
    }
    for (std::size_t i = random() % 4; i > 0 && !payload.empty(); --i) {
      payload[random() % payload.size()] = static_cast<std::byte>(random() % 4);
    }
    out_.clear();
    sut_.receive(ScriptedMid360::frame(static_cast<std::uint32_t>(random() % 60), kCommandsOfAll[random() % 6],
                                       random() % 2 == 0, payload),
                 kCommands, now_, out_);
    if (round % 7 == 0) {
      now_ += milliseconds{50};
      sut_.advance(now_, out_);
    }
  }
  out_.clear();
  device_.on = false;
  run(seconds{10});
  device_.on = true;

  run(seconds{10});

  EXPECT_EQ(sut_.state(), Sdk2HostState::kSampling);
}

TEST_F(Sdk2HostTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Bytes found = device_.discovery_ack(1);
  const Bytes push = device_.push({Sdk2Key::kWorkState, Sdk2Key::kHealth});

  const std::size_t allocations = support::count_allocations([&] {
    sut_.advance(now_, out_);
    sut_.receive(found, kDiscovery, now_, out_);
    sut_.receive(push, kCommands, now_, out_);
    sut_.advance(now_ + seconds{1}, out_);
  });

  EXPECT_EQ(sut_.state(), Sdk2HostState::kReading);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::livox
