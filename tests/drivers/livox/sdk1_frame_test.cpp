#include "drivers/livox/sdk1_frame.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "drivers/livox/sdk1_messages.hpp"
#include "tests/hex/hex.hpp"

namespace slamd::livox {
namespace {

using hex::Bytes;
using hex::from_hex;
using hex::to_hex;

// Every control frame among the golden vectors of livox-sdk1.md.
constexpr std::string_view kFrames[] = {
    "AA010F0000000004D7000338BA8D0C",
    "AA010F00000200B4E40003600E1A7A",
    "AA010F0000000004D70002AE8A8A7B",
    "AA010F000003006CFD0002DAE45636",
    "AA0114000103001C540002000B060000D20A5599",
    "AA012200020000597E0000334A45444B3338303031305A333931000700009DBD7AD7",
    "AA01190000010004410001C0A80132C1DACDD8C1DA50E156F8",
    "AA011900010100D81B0001C0A80132C1DACDD8C1DA16CEA8C2",
    "AA011000010100BC4A000100C813DF1B",
    "AA01170000000064390001C0A82101BD07E8FD1E25F912",
    "AA0110000100006453000100F1343C29",
    "AA0116000102004C5B0003000100000000003E69F023",
    "AA0116000102004C5B00030000002A000000C1F52327",
    "AA0116000102004C5B0003000100006000001EA2276B",
    "AA011000000400D86E000401C611DFCC",
    "AA011000000500007700040069063B89",
    "AA011000000600685D000500635E05C7",
    "AA011000000700B044000501CC49E182",
    "AA010F00000800C41900069699C87D",
    "AA010F0000000004D70006B74EE77C",
    "AA011300020900D476000701000040607D6C0D",
    "AA011000000A00C8F4010003C6325DA5",
    "AA011000000A00C8F4010001EA53534B",
    "AA011000000000B809010002AB73F4FB",
    "AA011000000B0010ED01060379B2E4C1",
    "AA011000000000B80901060001B5A043",
    "AA011000000000B8090106022DD4AEAD",
    "AA011000000C0018A0010801740BC02D",
    "AA011000000000B80901080119A824AA",
    "AA012700000D00CD5D01010000803F000000C00000B4426400000038FFFFFF2C01000033CBA0DD",
    "AA012800010E0085470102000000803F000000C00000B4426400000038FFFFFF2C010000011826B3",
    "AA011700000F00ACBA010A1A0B1606001764072B28F0E2",
    "AA01140000100039B1000B020001000124AB34CE",
    "AA0112000011007993000C010200CB8FF703",
    "AA011100001200DDA4000AE803A9E5D034",
    "AA011400000000A8240008000000000068F8DD50",
};

FrameResult parse(std::span<const std::byte> bytes, Sdk1Frame& frame) {
  std::size_t size = 0;
  return parse_sdk1_frame(bytes, frame, size);
}

/// The frame of a golden vector, whose bytes live as long as this.
struct Golden {
  explicit Golden(std::string_view hex) : bytes(from_hex(hex)) {
    EXPECT_EQ(parse_sdk1_frame(bytes, frame, size), FrameResult::kOk) << hex;
  }

  /// The same frame around another payload.
  std::string with(const Payload& payload) const {
    Sdk1Frame again = frame;
    again.payload = payload.view();
    return to_hex(write_sdk1_frame(again).view());
  }

  Bytes bytes;
  Sdk1Frame frame;
  std::size_t size = 0;
};

TEST(Sdk1FrameCodec, GivesEveryGoldenFrameBackWhenEncodedAgain) {
  for (const std::string_view hex : kFrames) {
    const Golden golden(hex);

    EXPECT_EQ(golden.size, golden.bytes.size());
    EXPECT_EQ(to_hex(write_sdk1_frame(golden.frame).view()), hex);
  }
}

TEST(Sdk1FrameCodec, RefusesEveryFlippedBitOfEveryGoldenFrame) {
  for (const std::string_view hex : kFrames) {
    const Bytes good = from_hex(hex);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes bytes = good;
      bytes[bit / 8] ^= std::byte{1} << bit % 8;
      Sdk1Frame frame;

      ASSERT_NE(parse(bytes, frame), FrameResult::kOk) << hex << " bit " << bit;
    }
  }
}

TEST(Sdk1FrameCodec, RefusesEveryTruncation) {
  for (const std::string_view hex : kFrames) {
    const Bytes good = from_hex(hex);
    for (std::size_t size = 0; size < good.size(); ++size) {
      Sdk1Frame frame;

      ASSERT_EQ(parse(std::span(good).first(size), frame), size < 15 ? FrameResult::kTooShort : FrameResult::kWrongLength);
    }
  }
}

TEST(Sdk1FrameCodec, NamesEachRefusalByItsReason) {
  const Bytes good = from_hex(kFrames[0]);
  Bytes sdk2 = good;
  sdk2[1] = std::byte{0};
  Bytes sof = good;
  sof[0] = std::byte{0x55};
  Bytes shorter_than_a_frame = good;
  shorter_than_a_frame[2] = std::byte{14};
  Bytes header = good;
  header[5] = std::byte{1};
  Bytes body = good;
  body[10] = std::byte{4};
  Sdk1Frame frame;

  EXPECT_EQ(parse(sdk2, frame), FrameResult::kUnknownVersion);
  EXPECT_EQ(parse(sof, frame), FrameResult::kNotAFrame);
  EXPECT_EQ(parse(shorter_than_a_frame, frame), FrameResult::kWrongLength);
  EXPECT_EQ(parse(header, frame), FrameResult::kBadHeaderChecksum);
  EXPECT_EQ(parse(body, frame), FrameResult::kBadChecksum);
  EXPECT_EQ(name_of(FrameResult::kBadHeaderChecksum), "bad_header_checksum");
}

TEST(Sdk1FrameCodec, TellsWhereTheNextFrameOfADatagramBegins) {
  Bytes datagram = from_hex(kFrames[8]);
  const Bytes second = from_hex(kFrames[11]);
  datagram.insert(datagram.end(), second.begin(), second.end());
  Sdk1Frame frame;
  std::size_t size = 0;

  ASSERT_EQ(parse_sdk1_frame(datagram, frame, size), FrameResult::kOk);
  EXPECT_EQ(size, 16U);
  ASSERT_EQ(parse_sdk1_frame(std::span(datagram).subspan(size), frame, size), FrameResult::kOk);
  EXPECT_EQ(frame.command, Sdk1Command::kHeartbeat);
}

TEST(Sdk1Messages, ReadTheBroadcast) {
  const Golden golden("AA012200020000597E0000334A45444B3338303031305A333931000700009DBD7AD7");
  const auto sut = Sdk1Broadcast::parse(golden.frame.payload);

  ASSERT_TRUE(sut);
  EXPECT_EQ(golden.frame.type, Sdk1FrameType::kMessage);
  EXPECT_EQ(golden.frame.command, Sdk1Command::kBroadcast);
  EXPECT_EQ(sut->code.view(), "3JEDK380010Z391");
  EXPECT_EQ(sut->device_type, 7);
  EXPECT_EQ(golden.with(sut->bytes()), to_hex(golden.bytes));
}

TEST(Sdk1Messages, ReadTheHandshakeWithAndWithoutAnInertialPort) {
  const Golden golden("AA01190000010004410001C0A80132C1DACDD8C1DA50E156F8");
  const Golden old("AA01170000000064390001C0A82101BD07E8FD1E25F912");
  const auto sut = Sdk1Handshake::parse(golden.frame.payload);
  const auto without = Sdk1Handshake::parse(old.frame.payload);

  ASSERT_TRUE(sut && without);
  EXPECT_EQ(sut->host_address, 0xC0A80132U);
  EXPECT_EQ(sut->data_port, 56001);
  EXPECT_EQ(sut->command_port, 55501);
  EXPECT_EQ(sut->imu_port, 56001);
  EXPECT_EQ(without->host_address, 0xC0A82101U);
  EXPECT_EQ(without->data_port, 1981);
  EXPECT_EQ(without->command_port, 65000);
  EXPECT_FALSE(without->imu_port);
  EXPECT_EQ(golden.with(sut->bytes()), to_hex(golden.bytes));
  EXPECT_EQ(old.with(without->bytes()), to_hex(old.bytes));
}

TEST(Sdk1Messages, ReadTheAnswersToHeartbeats) {
  struct Expected {
    std::string_view hex;
    Sdk1WorkState state;
    std::uint32_t status;
  };
  for (const Expected& e :
       {Expected{"AA0116000102004C5B0003000100000000003E69F023", Sdk1WorkState::kNormal, 0},
        Expected{"AA0116000102004C5B00030000002A000000C1F52327", Sdk1WorkState::kInitialising, 42},
        Expected{"AA0116000102004C5B0003000100006000001EA2276B", Sdk1WorkState::kNormal, 0x6000}}) {
    const Golden golden(e.hex);
    const auto sut = Sdk1HeartbeatAck::parse(golden.frame.payload);

    ASSERT_TRUE(sut);
    EXPECT_EQ(golden.frame.sequence, 2);
    EXPECT_EQ(sut->state, e.state);
    EXPECT_EQ(sut->status_or_progress, e.status);
    EXPECT_EQ(golden.with(sut->bytes()), e.hex);
  }
}

TEST(Sdk1Messages, ReadTheFirmware) {
  const Golden golden("AA0114000103001C540002000B060000D20A5599");
  const auto sut = Sdk1DeviceInfo::parse(golden.frame.payload);

  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->firmware, (std::array<std::uint8_t, 4>{11, 6, 0, 0}));
  EXPECT_EQ(golden.with(sut->bytes()), to_hex(golden.bytes));
}

TEST(Sdk1Messages, ReadTheExtrinsicThatIsSetAndTheOneThatIsTold) {
  const Golden set("AA012700000D00CD5D01010000803F000000C00000B4426400000038FFFFFF2C01000033CBA0DD");
  const Golden told("AA012800010E0085470102000000803F000000C00000B4426400000038FFFFFF2C010000011826B3");
  const auto sut = Sdk1Extrinsic::parse(set.frame.payload);
  const auto answer = Sdk1Extrinsic::parse(told.frame.payload.subspan(1));

  ASSERT_TRUE(sut && answer);
  EXPECT_EQ(sut->rpy_deg, (std::array<float, 3>{1.0F, -2.0F, 90.0F}));
  EXPECT_EQ(sut->xyz_mm, (std::array<std::int32_t, 3>{100, -200, 300}));
  EXPECT_EQ(answer->xyz_mm, sut->xyz_mm);
  EXPECT_EQ(set.with(sut->bytes()), to_hex(set.bytes));
}

TEST(Sdk1Messages, ReadTheTime) {
  const Golden golden("AA011700000F00ACBA010A1A0B1606001764072B28F0E2");
  const auto sut = Sdk1Utc::parse(golden.frame.payload);

  ASSERT_TRUE(sut);
  EXPECT_EQ(*sut, (Sdk1Utc{2026, 11, 22, 6, 124'000'000}));
  EXPECT_EQ(golden.with(sut->bytes()), to_hex(golden.bytes));
}

TEST(Sdk1Messages, ReadAParameter) {
  const Golden golden("AA01140000100039B1000B020001000124AB34CE");
  const auto sut = Sdk1Parameter::parse(golden.frame.payload);

  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->key, 2);
  EXPECT_EQ(sut->value, 1);
  EXPECT_EQ(golden.with(sut->bytes()), to_hex(golden.bytes));
}

TEST(Sdk1Messages, RefuseAnyOtherLength) {
  for (std::size_t size = 0; size < 40; ++size) {
    const Bytes bytes(size);

    EXPECT_EQ(Sdk1Broadcast::parse(bytes).has_value(), size == 19);
    EXPECT_EQ(Sdk1Handshake::parse(bytes).has_value(), size == 8 || size == 10);
    EXPECT_EQ(Sdk1HeartbeatAck::parse(bytes).has_value(), size == 7);
    EXPECT_EQ(Sdk1DeviceInfo::parse(bytes).has_value(), size == 5);
    EXPECT_EQ(Sdk1Extrinsic::parse(bytes).has_value(), size == 24);
    EXPECT_EQ(Sdk1Utc::parse(bytes).has_value(), size == 8);
    EXPECT_EQ(result_of(bytes).has_value(), size > 0);
  }
}

}  // namespace
}  // namespace slamd::livox
