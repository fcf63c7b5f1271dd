#include "drivers/livox/sdk2_frame.hpp"

#include <gtest/gtest.h>

#include <string_view>

#include "core/base/bytes.hpp"
#include "tests/hex/hex.hpp"

namespace slamd::livox {
namespace {

using hex::Bytes;
using hex::from_hex;
using hex::to_hex;

// The control frames among the golden vectors of livox-sdk2.md.
constexpr std::string_view kDiscovery = "AA0018000100000000000000000000000000A91F00000000";
constexpr std::string_view kDiscoveryAck =
    "AA00300001000000000001010000000000008AB7378C8B17000934374D444C3132333435363738393000C0A8017024DB";
constexpr std::string_view kWorkMode = "AA002100020000000001000000000000000096A56FD5E7AD010000001A00010001";
constexpr std::string_view kWorkModeAck = "AA001B000200000000010101000000000000D66E12D941FF000000";
constexpr std::string_view kDestinations =
    "AA0040000300000000010000000000000000EFBCCAB502B50300000005000800C0A8010589DB88DB06000800C0A80105EDDBECDB07000800C0A8"
    "010551DC50DC";
constexpr std::string_view kQuestion = "AA0020000400000001010000000000000000906932E7D07D0200000000800680";
constexpr std::string_view kAnswer = "AA00200004000000010101010000000000002296E7CD89D70001000680010001";
constexpr std::string_view kPush =
    "AA0029000500000002010001000000000000FEA2E74881520200000006800100010780040075100000";
constexpr std::string_view kGpsTime = "AA0021000600000002020000000000000000FDAB05CDF243020098926AB048EA18";

constexpr std::string_view kFrames[] = {kDiscovery, kDiscoveryAck, kWorkMode, kWorkModeAck, kDestinations,
                                        kQuestion,  kAnswer,       kPush,     kGpsTime};

FrameResult parse(std::span<const std::byte> bytes, Sdk2Frame& frame) {
  std::size_t size = 0;
  return parse_sdk2_frame(bytes, frame, size);
}

/// The frame of a golden vector, whose bytes live as long as this.
struct Golden {
  explicit Golden(std::string_view hex) : bytes(from_hex(hex)) { EXPECT_EQ(parse(bytes, frame), FrameResult::kOk) << hex; }

  /// The same frame around another payload.
  std::string with(std::span<const std::byte> payload) const {
    Sdk2Frame again = frame;
    again.payload = payload;
    return to_hex(write_sdk2_frame(again).view());
  }

  Bytes bytes;
  Sdk2Frame frame;
};

TEST(Sdk2FrameCodec, GivesEveryGoldenFrameBackWhenEncodedAgain) {
  for (const std::string_view hex : kFrames) {
    const Golden golden(hex);

    EXPECT_EQ(to_hex(write_sdk2_frame(golden.frame).view()), hex);
  }
}

TEST(Sdk2FrameCodec, RefusesEveryFlippedBitOfEveryGoldenFrame) {
  for (const std::string_view hex : kFrames) {
    const Bytes good = from_hex(hex);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes bytes = good;
      bytes[bit / 8] ^= std::byte{1} << bit % 8;
      Sdk2Frame frame;

      ASSERT_NE(parse(bytes, frame), FrameResult::kOk) << hex << " bit " << bit;
    }
  }
}

TEST(Sdk2FrameCodec, RefusesEveryTruncation) {
  for (const std::string_view hex : kFrames) {
    const Bytes good = from_hex(hex);
    for (std::size_t size = 0; size < good.size(); ++size) {
      Sdk2Frame frame;

      ASSERT_EQ(parse(std::span(good).first(size), frame), size < 24 ? FrameResult::kTooShort : FrameResult::kWrongLength);
    }
  }
}

TEST(Sdk2FrameCodec, NamesEachRefusalByItsReason) {
  Bytes sdk1 = from_hex(kWorkMode);
  sdk1[1] = std::byte{1};
  Bytes sof = from_hex(kWorkMode);
  sof[0] = std::byte{0x55};
  Bytes short_length = from_hex(kWorkMode);
  short_length[2] = std::byte{23};
  Bytes header = from_hex(kWorkMode);
  header[4] = std::byte{9};
  Bytes body = from_hex(kWorkMode);
  body[32] = std::byte{2};
  Sdk2Frame frame;

  EXPECT_EQ(parse(sdk1, frame), FrameResult::kUnknownVersion);
  EXPECT_EQ(parse(sof, frame), FrameResult::kNotAFrame);
  EXPECT_EQ(parse(short_length, frame), FrameResult::kWrongLength);
  EXPECT_EQ(parse(header, frame), FrameResult::kBadHeaderChecksum);
  EXPECT_EQ(parse(body, frame), FrameResult::kBadChecksum);
}

TEST(Sdk2Messages, ReadTheAnswerToADiscovery) {
  const Golden golden(kDiscoveryAck);
  const auto sut = Sdk2Discovery::parse(golden.frame.payload);

  ASSERT_TRUE(sut);
  EXPECT_TRUE(golden.frame.ack && golden.frame.from_device);
  EXPECT_EQ(sut->device_type, 9);
  EXPECT_EQ(sut->serial_number.view(), "47MDL1234567890");
  EXPECT_EQ(sut->address, 0xC0A80170U);
  EXPECT_EQ(sut->command_port, 56100);
  EXPECT_EQ(golden.with(sut->bytes().view()), kDiscoveryAck);
}

TEST(Sdk2Messages, BuildSettings) {
  Sdk2ValueWriter mode;
  mode.add(Sdk2Key::kWorkMode, std::uint8_t{1});
  Sdk2ValueWriter destinations;
  destinations.add(Sdk2Key::kStateDestination, Sdk2Destination{0xC0A80105, 56201, 56200}.bytes().view());
  destinations.add(Sdk2Key::kPointDestination, Sdk2Destination{0xC0A80105, 56301, 56300}.bytes().view());
  destinations.add(Sdk2Key::kImuDestination, Sdk2Destination{0xC0A80105, 56401, 56400}.bytes().view());

  EXPECT_EQ(Golden(kWorkMode).with(mode.payload()), kWorkMode);
  EXPECT_EQ(Golden(kDestinations).with(destinations.payload()), kDestinations);
}

TEST(Sdk2Messages, ReadDestinations) {
  const Golden golden(kDestinations);
  Sdk2ValueReader sut = Sdk2ValueReader::of_push(golden.frame.payload);
  Sdk2Value value;

  ASSERT_TRUE(sut.next(value));
  EXPECT_EQ(value.key, Sdk2Key::kStateDestination);
  ASSERT_TRUE(sut.next(value));
  EXPECT_EQ(Sdk2Destination::parse(value.bytes), (Sdk2Destination{0xC0A80105, 56301, 56300}));
  ASSERT_TRUE(sut.next(value));
  EXPECT_FALSE(sut.next(value));
  EXPECT_TRUE(sut.complete());
}

TEST(Sdk2Messages, AskAndReadAnswers) {
  constexpr Sdk2Key kKeys[] = {Sdk2Key::kSerialNumber, Sdk2Key::kWorkState};
  EXPECT_EQ(Golden(kQuestion).with(sdk2_question(kKeys).view()), kQuestion);

  const Golden golden(kAnswer);
  Sdk2ValueReader sut = Sdk2ValueReader::of_answer(golden.frame.payload);
  Sdk2Value value;
  ASSERT_TRUE(sut.next(value));
  EXPECT_EQ(value.key, Sdk2Key::kWorkState);
  EXPECT_EQ(value.as_u8(), 1);
  EXPECT_TRUE(sut.complete());
  Sdk2ValueWriter again(0);
  again.add(value.key, value.bytes);
  EXPECT_EQ(golden.with(again.payload()), kAnswer);
}

TEST(Sdk2Messages, ReadTheStatePush) {
  const Golden golden(kPush);
  Sdk2ValueReader sut = Sdk2ValueReader::of_push(golden.frame.payload);
  Sdk2Value state;
  Sdk2Value temperature;

  ASSERT_TRUE(sut.next(state) && sut.next(temperature));
  EXPECT_FALSE(golden.frame.ack);
  EXPECT_TRUE(golden.frame.from_device);
  EXPECT_EQ(state.as_u8(), 1);
  EXPECT_EQ(temperature.key, Sdk2Key::kTemperature);
  EXPECT_EQ(temperature.as_u32(), 4213U);
  Sdk2ValueWriter again;
  again.add(state.key, state.bytes);
  again.add(temperature.key, temperature.bytes);
  EXPECT_EQ(golden.with(again.payload()), kPush);
}

TEST(Sdk2Messages, ReadTheGpsTime) {
  const Golden golden(kGpsTime);
  const auto sut = Sdk2GpsTime::parse(golden.frame.payload);

  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->utc_ns, 1'795'327'324'000'000'000U);
  EXPECT_EQ(golden.with(sut->bytes().view()), kGpsTime);
}

TEST(Sdk2Messages, EndWhereTheBytesContradictTheLengths) {
  for (const std::string_view hex : {"", "01", "010000", "02000000068001000", "0100000006800200FF", "01000000FFFFFFFF"}) {
    const Bytes payload = from_hex(hex);
    Sdk2ValueReader sut = Sdk2ValueReader::of_push(payload);
    Sdk2Value value;
    int values = 0;

    while (sut.next(value)) {
      ++values;
    }

    EXPECT_LE(values, 1);
    EXPECT_FALSE(sut.complete()) << hex;
  }
  const Bytes more = from_hex("0000000000");
  EXPECT_FALSE(Sdk2ValueReader::of_push(more).complete());
}

}  // namespace
}  // namespace slamd::livox
