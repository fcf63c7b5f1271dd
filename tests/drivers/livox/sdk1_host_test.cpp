#include "drivers/livox/sdk1_host.hpp"

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
using hex::to_hex;

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Endpoint kAvia{0xC0A80170, 65000};  // 192.168.1.112
constexpr std::string_view kCode = "3JEDK380010Z391";

/// An Avia that does what the test wants. Source: livox-sdk1.md §3, §7.
class ScriptedAvia {
 public:
  bool on = true;
  bool silent_to_commands = false;
  std::uint8_t handshake_result = 0;
  std::uint8_t heartbeat_result = 0;
  Sdk1WorkState state = Sdk1WorkState::kNormal;
  std::uint32_t status = 0;
  std::uint32_t progress = 0;
  Sdk1Extrinsic extrinsic{{1.0F, -2.0F, 90.0F}, {100, -200, 300}};
  std::map<Sdk1Command, std::uint8_t> refusals;
  int lose_answers = 0;
  bool sampling = false;
  bool bound = false;
  std::vector<Sdk1Command> heard;
  std::vector<Bytes> payloads;
  std::optional<Sdk1Handshake> host;

  Bytes broadcast() const {
    return frame(Sdk1FrameType::kMessage, 0, Sdk1Command::kBroadcast,
                 Sdk1Broadcast{DeviceCode::of(kCode), 7, 0}.bytes());
  }

  static Bytes frame(Sdk1FrameType type, std::uint16_t sequence, Sdk1Command command, const Payload& payload) {
    const FrameBytes bytes = write_sdk1_frame({type, sequence, command, payload.view()});
    return {bytes.begin(), bytes.end()};
  }

  /// What it answers to a datagram, if anything.
  std::optional<Bytes> answer(std::span<const std::byte> datagram) {
    Sdk1Frame request;
    std::size_t size = 0;
    EXPECT_EQ(parse_sdk1_frame(datagram, request, size), FrameResult::kOk);
    heard.push_back(request.command);
    payloads.emplace_back(request.payload.begin(), request.payload.end());
    if (!on || (silent_to_commands && request.command != Sdk1Command::kHeartbeat) || lose_answers-- > 0) {
      return std::nullopt;
    }
    lose_answers = 0;
    return frame(Sdk1FrameType::kAck, request.sequence, request.command, payload_for(request));
  }

  std::size_t times(Sdk1Command command) const {
    return static_cast<std::size_t>(std::count(heard.begin(), heard.end(), command));
  }

  const Bytes& last_payload(Sdk1Command command) const {
    const auto found = std::find(heard.rbegin(), heard.rend(), command);
    return payloads[static_cast<std::size_t>(heard.rend() - found) - 1];
  }

 private:
  Payload payload_for(const Sdk1Frame& request) {
    const auto refusal = refusals.find(request.command);
    if (refusal != refusals.end()) {
      return one_byte(refusal->second);
    }
    switch (request.command) {
      case Sdk1Command::kHandshake:
        host = Sdk1Handshake::parse(request.payload);
        bound = handshake_result == 0;
        return one_byte(handshake_result);
      case Sdk1Command::kHeartbeat:
        return Sdk1HeartbeatAck{heartbeat_result, state, 0,
                                state == Sdk1WorkState::kInitialising ? progress : status}
            .bytes();
      case Sdk1Command::kDeviceInfo:
        return Sdk1DeviceInfo{0, {11, 6, 0, 0}}.bytes();
      case Sdk1Command::kGetExtrinsic: {
        Payload payload = one_byte(0);
        for (const std::byte byte : extrinsic.bytes()) {
          payload.push_back(byte);
        }
        return payload;
      }
      case Sdk1Command::kSampling:
        sampling = request.payload[0] == std::byte{1};
        return one_byte(0);
      case Sdk1Command::kSetMode:
        state = static_cast<Sdk1WorkState>(request.payload[0]);
        sampling = false;
        return one_byte(0);
      case Sdk1Command::kDisconnect:
        bound = false;
        return one_byte(0);
      default:
        return one_byte(0);
    }
  }
};

Sdk1HostConfig config() {
  Sdk1HostConfig config;
  config.interfaces.push_back({0x0A000001, 0xFF000000});
  config.interfaces.push_back({0xC0A80132, 0xFFFFFF00});
  return config;
}

/// The device broadcasts each second while it is not bound.
class Sdk1HostTest : public HostWire<Sdk1Host, ScriptedAvia> {
 protected:
  Sdk1HostTest() : HostWire(Sdk1Host(config()), kAvia) {}

  void device_advances() override {
    if (device_.on && !device_.bound && now_ >= next_broadcast_) {
      next_broadcast_ = now_ + seconds{1};
      give(device_.broadcast(), kAvia);
    }
  }

  Stamp next_broadcast_{};
};

TEST_F(Sdk1HostTest, WaitsForABroadcastAndSaysAfterFiveSecondsThatThereIsNone) {
  device_.on = false;

  run(milliseconds{4900});
  EXPECT_TRUE(events_.empty());
  run(seconds{10});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSearching);
  ASSERT_EQ(told(HostEventKind::kNotSeen), 1U);
  EXPECT_EQ(words_for(events_[0]),
            "no device is not to be heard looking for a host: off, of another subnet, or held by another host");
  EXPECT_TRUE(device_.heard.empty());
}

TEST_F(Sdk1HostTest, AnswersABroadcastWithAHandshakeThatNamesItsPorts) {
  run(milliseconds{50});

  ASSERT_TRUE(device_.host);
  EXPECT_EQ(device_.host->host_address, 0xC0A80132U);
  EXPECT_EQ(device_.host->command_port, 55501);
  EXPECT_EQ(device_.host->data_port, 56001);
  EXPECT_EQ(device_.host->imu_port, 56001);
  EXPECT_EQ(sut_.code().view(), kCode);
  EXPECT_EQ(told(HostEventKind::kFound), 1U);
  EXPECT_EQ(told(HostEventKind::kConnected), 1U);
  EXPECT_EQ(last_words(HostEventKind::kConnected), "3JEDK380010Z391 at 192.168.1.112 is connected");
}

TEST_F(Sdk1HostTest, ConfiguresTheDeviceInTheDriversOrderAndStartsIt) {
  Sdk1HostConfig with_mode = config();
  with_mode.return_mode = 2;
  sut_ = Sdk1Host(with_mode);

  run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_TRUE(device_.sampling);
  EXPECT_EQ(device_.heard, (std::vector{Sdk1Command::kHandshake, Sdk1Command::kHeartbeat, Sdk1Command::kDeviceInfo,
                                      Sdk1Command::kCoordinate, Sdk1Command::kSetReturnMode, Sdk1Command::kSetImuRate,
                                      Sdk1Command::kGetExtrinsic, Sdk1Command::kSampling, Sdk1Command::kHeartbeat}));
  EXPECT_EQ(device_.last_payload(Sdk1Command::kSetReturnMode), Bytes{std::byte{2}});
  EXPECT_EQ(device_.last_payload(Sdk1Command::kSetImuRate), Bytes{std::byte{1}});
  EXPECT_EQ(device_.last_payload(Sdk1Command::kCoordinate), Bytes{std::byte{0}});
  EXPECT_EQ(last_words(HostEventKind::kIdentified), "3JEDK380010Z391 has firmware 11.6.0.0");
  ASSERT_TRUE(sut_.extrinsic());
  EXPECT_EQ(sut_.extrinsic()->xyz_mm, (std::array<std::int32_t, 3>{100, -200, 300}));
  EXPECT_EQ(last_words(HostEventKind::kExtrinsicRead),
            "3JEDK380010Z391 has an extrinsic stored: xyz_m = [0.100, -0.200, 0.300], rpy_deg = [1, -2, 90]");
}

TEST_F(Sdk1HostTest, SaysThatNoExtrinsicIsStored) {
  device_.extrinsic = {};

  run(seconds{1});

  EXPECT_EQ(last_words(HostEventKind::kExtrinsicRead), "3JEDK380010Z391 has no extrinsic stored");
}

TEST_F(Sdk1HostTest, SamplesWithoutAnExtrinsicThatIsRefusedOrNotWhole) {
  for (const bool refused : {true, false}) {
    SCOPED_TRACE(refused);
    sut_ = Sdk1Host(config());
    events_.clear();
    device_.bound = false;
    device_.refusals.clear();
    device_.refusals[Sdk1Command::kGetExtrinsic] = refused ? 1 : 0;  // an answer of one byte, whichever

    run(seconds{2});

    EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
    EXPECT_FALSE(sut_.extrinsic());
    EXPECT_EQ(told(HostEventKind::kExtrinsicRead), 0U);
    EXPECT_EQ(told(HostEventKind::kCommandFailed), refused ? 1U : 0U);
    EXPECT_EQ(sut_.counters().unexpected, refused ? 0U : 1U);
  }
}

TEST_F(Sdk1HostTest, ReadsTheExtrinsicAgainFromADeviceThatComesBack) {
  run(seconds{1});
  device_.extrinsic.xyz_mm = {0, 0, 500};
  device_.bound = false;  // switched off and on
  run(seconds{3});

  EXPECT_EQ(told(HostEventKind::kExtrinsicRead), 2U);
  EXPECT_EQ(sut_.extrinsic(), device_.extrinsic);
}

TEST_F(Sdk1HostTest, DoesNotReadTheExtrinsicWhenThatIsNotWanted) {
  Sdk1HostConfig without = config();
  without.read_extrinsic = false;
  sut_ = Sdk1Host(without);

  run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_EQ(device_.times(Sdk1Command::kGetExtrinsic), 0U);
}

TEST_F(Sdk1HostTest, SendsAHeartbeatAtLeastEverySecond) {
  run(seconds{20});

  EXPECT_GE(device_.times(Sdk1Command::kHeartbeat), 23U);
  EXPECT_LE(device_.times(Sdk1Command::kHeartbeat), 26U);
  EXPECT_EQ(told(HostEventKind::kSampling), 1U);
  EXPECT_EQ(told(HostEventKind::kLost), 0U);
}

TEST_F(Sdk1HostTest, WaitsUntilTheDeviceHasInitialised) {
  device_.state = Sdk1WorkState::kInitialising;
  device_.progress = 42;
  run(seconds{2});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kWaiting);
  EXPECT_EQ(last_words(HostEventKind::kInitialising), "3JEDK380010Z391 initialises: 42 %");
  EXPECT_EQ(told(HostEventKind::kInitialising), 1U);
  EXPECT_EQ(device_.times(Sdk1Command::kCoordinate), 0U);

  device_.state = Sdk1WorkState::kNormal;
  run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, WakesADeviceThatRests) {
  device_.state = Sdk1WorkState::kPowerSaving;

  run(seconds{1});

  EXPECT_EQ(device_.last_payload(Sdk1Command::kSetMode), Bytes{std::byte{1}});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, PutsTheDeviceToRestAndWakesItWhenTold) {
  run(seconds{1});

  sut_.set_mode(Sdk1Mode::kStandby, now_, out_);
  deliver();
  EXPECT_EQ(sut_.state(), Sdk1HostState::kResting);
  EXPECT_EQ(device_.state, Sdk1WorkState::kStandby);
  sut_.set_mode(Sdk1Mode::kNormal, now_, out_);
  deliver();

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_TRUE(device_.sampling);
}

TEST_F(Sdk1HostTest, SaysWhichModeChangeIsRefused) {
  run(seconds{1});
  device_.refusals[Sdk1Command::kSetMode] = 1;

  sut_.set_mode(Sdk1Mode::kStandby, now_, out_);
  run(milliseconds{100});

  EXPECT_EQ(last_words(HostEventKind::kCommandFailed), "3JEDK380010Z391 refuses with code 1: change the mode");
  EXPECT_EQ(device_.times(Sdk1Command::kSetMode), 1U);  // the next try comes with a later heartbeat
}

TEST_F(Sdk1HostTest, ConfiguresADeviceAgainThatHasGoneThroughAnError) {
  run(seconds{1});
  device_.state = Sdk1WorkState::kError;
  run(seconds{1});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kWaiting);

  device_.state = Sdk1WorkState::kNormal;
  run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_EQ(device_.times(Sdk1Command::kSampling), 2U);
}

TEST_F(Sdk1HostTest, AsksAgainForAnswersThatGetLost) {
  device_.lose_answers = 2;  // of the handshake
  run(milliseconds{1100});
  EXPECT_EQ(device_.times(Sdk1Command::kHandshake), 3U);
  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_EQ(told(HostEventKind::kNoAnswer), 0U);
}

TEST_F(Sdk1HostTest, SaysThatADeviceDoesNotAnswerAndTriesAtItsNextBroadcast) {
  device_.silent_to_commands = true;
  run(milliseconds{1600});
  EXPECT_EQ(told(HostEventKind::kNoAnswer), 1U);
  EXPECT_EQ(device_.times(Sdk1Command::kHandshake), 3U);

  device_.silent_to_commands = false;
  run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, GoesOnWithoutAStepThatIsRefusedOrNotAnswered) {
  device_.refusals[Sdk1Command::kSetImuRate] = 1;
  run(seconds{1});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_EQ(last_words(HostEventKind::kCommandFailed),
            "3JEDK380010Z391 refuses with code 1: set the inertial sensor's rate");
}

TEST_F(Sdk1HostTest, SaysWhichStepIsNotAnsweredAndGoesOn) {
  run(milliseconds{50});
  device_.bound = false;
  device_.on = true;
  sut_ = Sdk1Host(config());
  events_.clear();
  device_.state = Sdk1WorkState::kInitialising;
  run(seconds{1});
  device_.silent_to_commands = true;
  device_.state = Sdk1WorkState::kNormal;

  run(seconds{3});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kConfiguring);
  EXPECT_EQ(last_words(HostEventKind::kCommandFailed), "3JEDK380010Z391 does not answer: tell the firmware");
  EXPECT_EQ(device_.times(Sdk1Command::kDeviceInfo), 1U + 3U);
}

TEST_F(Sdk1HostTest, TriesToStartUntilTheDeviceDoes) {
  device_.refusals[Sdk1Command::kSampling] = 1;
  run(seconds{2});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kConfiguring);

  device_.refusals.clear();
  run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, SaysInWordsThatAnotherHostHoldsTheDeviceAndTakesItOnceItIsFree) {
  device_.handshake_result = 1;
  run(seconds{4});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kSearching);
  ASSERT_EQ(told(HostEventKind::kHeldByOther), 1U);  // once, however often it is tried
  EXPECT_EQ(last_words(HostEventKind::kHeldByOther),
            "3JEDK380010Z391 is held by another host: stop that one's driver or viewer, then this one takes over");
  EXPECT_GE(device_.times(Sdk1Command::kHandshake), 4U);

  device_.handshake_result = 0;
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, NoticesThatAnotherHostHasTakenTheDevice) {
  run(seconds{2});
  device_.heartbeat_result = 1;

  run(seconds{4});

  EXPECT_EQ(told(HostEventKind::kHeldByOther), 1U);
  EXPECT_EQ(sut_.state(), Sdk1HostState::kSearching);
}

TEST_F(Sdk1HostTest, DoesNotTouchADeviceOfAnotherSubnetAndSaysSoOnce) {
  const Endpoint elsewhere{0xC0A80270, 65000};
  for (int i = 0; i < 3; ++i) {
    give(device_.broadcast(), elsewhere);
  }

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSearching);
  EXPECT_TRUE(device_.heard.empty());
  ASSERT_EQ(told(HostEventKind::kWrongSubnet), 1U);
  EXPECT_EQ(words_for(events_[0]),
            "3JEDK380010Z391 at 192.168.2.112 is of another subnet than this host, and cannot be reached");
}

TEST_F(Sdk1HostTest, TakesOnlyTheDeviceThatItIsConfiguredFor) {
  Sdk1HostConfig other = config();
  other.device = DeviceCode::of("1HDDH1200100141");
  sut_ = Sdk1Host(other);

  run(seconds{3});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSearching);
  EXPECT_EQ(sut_.counters().strangers, 3U);
  EXPECT_TRUE(device_.heard.empty());
}

TEST_F(Sdk1HostTest, NoticesSilenceAfterThreeSecondsAndFindsTheDeviceAgain) {
  run(seconds{2});
  device_.on = false;
  device_.bound = false;
  run(milliseconds{2000});
  EXPECT_EQ(told(HostEventKind::kLost), 0U);
  run(milliseconds{2000});
  EXPECT_EQ(told(HostEventKind::kLost), 1U);
  EXPECT_EQ(sut_.state(), Sdk1HostState::kSearching);

  device_.on = true;
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_EQ(told(HostEventKind::kSampling), 2U);
}

TEST_F(Sdk1HostTest, TakesADeviceBackAtOnceThatLooksForAHostAgain) {
  run(seconds{2});
  device_.bound = false;  // rebooted faster than silence would show
  device_.sampling = false;

  run(milliseconds{1050});

  EXPECT_EQ(told(HostEventKind::kRestarted), 1U);
  EXPECT_EQ(told(HostEventKind::kLost), 0U);
  EXPECT_TRUE(device_.sampling);
}

TEST_F(Sdk1HostTest, IsNotMisledByABroadcastThatWasStillOnItsWay) {
  run(milliseconds{100});

  give(device_.broadcast(), kAvia);

  EXPECT_EQ(told(HostEventKind::kRestarted), 0U);
  EXPECT_EQ(device_.times(Sdk1Command::kHandshake), 1U);
}

TEST_F(Sdk1HostTest, PassesOnAnAbnormalStatusOnceInWords) {
  run(seconds{1});
  Payload status;
  for (const std::byte byte : from_hex("01000040")) {
    status.push_back(byte);
  }
  for (std::uint16_t i = 0; i < 20; ++i) {  // 10 Hz for two seconds
    give(ScriptedAvia::frame(Sdk1FrameType::kMessage, i, Sdk1Command::kAbnormalStatus, status), kAvia);
  }

  EXPECT_EQ(sut_.status_code(), 0x40000001U);
  EXPECT_EQ(last_words(HostEventKind::kStatusChanged),
            "3JEDK380010Z391 says: synchronised by none, temperature high or low, system warning");
  EXPECT_EQ(told(HostEventKind::kStatusChanged), 2U);  // the first was the heartbeat's: nothing wrong
}

TEST_F(Sdk1HostTest, TellsWhatTheClockIsSynchronisedBy) {
  run(seconds{1});
  device_.status = 0x6000;

  run(seconds{1});

  EXPECT_EQ(last_words(HostEventKind::kStatusChanged), "3JEDK380010Z391 says: synchronised by ptp");
}

TEST_F(Sdk1HostTest, TellsTheDeviceTheTimeOnceItIsConnected) {
  const Sdk1Utc utc{2026, 11, 22, 6, 124'000'000};
  EXPECT_FALSE(sut_.set_utc(utc, out_));
  run(seconds{1});

  EXPECT_TRUE(sut_.set_utc(utc, out_));
  deliver();

  EXPECT_EQ(to_hex(device_.last_payload(Sdk1Command::kSetUtc)), "1A0B160600176407");
  EXPECT_EQ(told(HostEventKind::kTimeSet), 1U);
}

TEST_F(Sdk1HostTest, StopsTheDeviceLetsItGoAndTakesItBack) {
  run(seconds{1});

  sut_.stop(out_);
  deliver();
  EXPECT_FALSE(device_.sampling);
  EXPECT_FALSE(device_.bound);
  EXPECT_EQ(sut_.state(), Sdk1HostState::kStopped);
  run(seconds{3});
  EXPECT_EQ(sut_.state(), Sdk1HostState::kStopped);  // whatever it broadcasts
  sut_.start();
  run(seconds{2});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, ReadsSeveralAnswersInOneDatagram) {
  run(seconds{1});
  Bytes datagram = ScriptedAvia::frame(Sdk1FrameType::kAck, 999, Sdk1Command::kHeartbeat,
                                       Sdk1HeartbeatAck{0, Sdk1WorkState::kNormal, 0, 0x6000}.bytes());
  const Bytes second = ScriptedAvia::frame(Sdk1FrameType::kAck, 998, Sdk1Command::kHeartbeat,
                                           Sdk1HeartbeatAck{0, Sdk1WorkState::kNormal, 0, 0x8200}.bytes());
  datagram.insert(datagram.end(), second.begin(), second.end());

  give(datagram, kAvia);

  EXPECT_EQ(sut_.status_code(), 0x8200U);
}

TEST_F(Sdk1HostTest, CountsAnswersOfStrangersAndLateOnesAndDoesNothing) {
  run(seconds{1});
  const Bytes late = ScriptedAvia::frame(Sdk1FrameType::kAck, 1, Sdk1Command::kHandshake, one_byte(1));

  give(late, kAvia);
  give(late, {0xC0A80133, 65000});
  give(from_hex("AA010F0000000004D7000338BA8D0D"), kAvia);

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
  EXPECT_EQ(sut_.counters().unexpected, 1U);
  EXPECT_EQ(sut_.counters().strangers, 1U);
  EXPECT_EQ(sut_.counters().frames[static_cast<std::size_t>(FrameResult::kBadChecksum)], 1U);
}

TEST_F(Sdk1HostTest, SurvivesAnyFramesAndStillReachesTheDevice) {
  std::mt19937 random(5);
  for (int round = 0; round < 3000; ++round) {
    Payload payload;
    for (std::size_t i = random() % 30; i > 0; --i) {
      payload.push_back(static_cast<std::byte>(random() % 4));
    }
    const auto command = static_cast<Sdk1Command>((random() % 2) << 8 | random() % 12);
    out_.clear();
    sut_.receive(ScriptedAvia::frame(static_cast<Sdk1FrameType>(random() % 3), static_cast<std::uint16_t>(random() % 60),
                                     command, payload),
                 kAvia, now_, out_);
    if (round % 7 == 0) {
      now_ += milliseconds{50};
      sut_.advance(now_, out_);
    }
  }
  out_.clear();

  run(seconds{10});

  EXPECT_EQ(sut_.state(), Sdk1HostState::kSampling);
}

TEST_F(Sdk1HostTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Bytes broadcast = device_.broadcast();
  const Bytes connected = ScriptedAvia::frame(Sdk1FrameType::kAck, 1, Sdk1Command::kHandshake, one_byte(0));
  const Bytes beat = ScriptedAvia::frame(Sdk1FrameType::kAck, 2, Sdk1Command::kHeartbeat,
                                         Sdk1HeartbeatAck{0, Sdk1WorkState::kNormal, 0, 0}.bytes());

  const std::size_t allocations = support::count_allocations([&] {
    sut_.receive(broadcast, kAvia, now_, out_);
    sut_.receive(connected, kAvia, now_, out_);
    sut_.receive(beat, kAvia, now_, out_);
    out_.clear();
    sut_.advance(now_ + seconds{1}, out_);
  });

  EXPECT_EQ(sut_.state(), Sdk1HostState::kConfiguring);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::livox
