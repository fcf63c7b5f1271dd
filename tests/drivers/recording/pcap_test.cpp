#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <string>

#include "drivers/recording/pcap_reader.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "made_capture.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::recording {
namespace {

using scratch::message_of;
using scratch::ScratchFolder;

using namespace std::chrono_literals;

constexpr std::uint16_t kIpv4Type = 0x0800;

Bytes frame_with(const std::string& payload, std::uint16_t port = 2368) {
  MadeDatagram datagram;
  datagram.payload = bytes_of(payload);
  datagram.destination_port = port;
  return ethernet(kIpv4Type, datagram.ipv4());
}

class PcapReaderTest : public ScratchFolder {
 protected:
  /// The payloads of a capture, one after the other with a blank behind each.
  std::string payloads_of(const std::string& capture) {
    PcapReader reader(write("capture.pcap", capture));
    Packet packet;
    std::string all;
    while (reader.next(packet)) {
      all += recording::text_of(packet.payload) + " ";
      last_ = packet;
    }
    counters_ = reader.counters();
    return all;
  }

  std::uint64_t frames() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : counters_.frames) {
      sum += count;
    }
    return sum;
  }

  Packet last_;
  PcapCounters counters_;
};

TEST_F(PcapReaderTest, ReadsClassicCapturesOfBothOrdersAndResolutions) {
  using Stamps = MadeCapture::Stamps;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const Stamps stamps : {Stamps::kMicroseconds, Stamps::kNanoseconds}) {
      MadeCapture capture(1, stamps, order);
      capture.add(frame_with("one"), 1'700'000'000, 1);
      capture.add(frame_with("two"), 1'700'000'001, 999'999);

      EXPECT_EQ(payloads_of(capture.text()), "one two ");

      const auto fraction = stamps == Stamps::kMicroseconds ? Duration(999'999us) : Duration(999'999ns);
      EXPECT_EQ(last_.received.time_since_epoch(), 1'700'000'001s + fraction);
      EXPECT_EQ(last_.source_address, 0xC0A801C9U);
      EXPECT_EQ(counters_.of(FrameKind::kUdp), 2U);
      EXPECT_FALSE(counters_.ended_in_a_record);
    }
  }
}

TEST_F(PcapReaderTest, ReadsStampsBeyond2038) {
  EXPECT_EQ(payloads_of(MadeCapture().add(frame_with("late"), 0xFFFFFFFFU, 5).text()), "late ");

  EXPECT_EQ(last_.received.time_since_epoch(), 4'294'967'295s + 5us);
}

TEST_F(PcapReaderTest, ReadsEachLinkLayer) {
  const Bytes ip = MadeDatagram{}.ipv4();
  const auto cooked = Written(std::endian::big).add_zeros(14).add(kIpv4Type).add_bytes(ip).bytes();
  const auto cooked2 = Written(std::endian::big).add(kIpv4Type).add_zeros(18).add_bytes(ip).bytes();
  const auto null = Written().add<std::uint32_t>(2).add_bytes(ip).bytes();
  // By the numbers that files use.
  EXPECT_EQ(payloads_of(MadeCapture(1).add(ethernet(kIpv4Type, ip)).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(1).add(ethernet(kIpv4Type, ip, 1)).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(1).add(ethernet(kIpv4Type, ip, 2)).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(113).add(cooked).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(276).add(cooked2).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(101).add(ip).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(228).add(ip).text()), "payload ");
  EXPECT_EQ(payloads_of(MadeCapture(0).add(null).text()), "payload ");
}

TEST_F(PcapReaderTest, CountsFramesOfAnUnknownLinkLayer) {
  EXPECT_EQ(payloads_of(MadeCapture(105).add(Bytes(100)).add(Bytes(100)).text()), "");

  EXPECT_EQ(counters_.of(FrameKind::kUnknownLink), 2U);
}

TEST_F(PcapReaderTest, AccountsForEveryFrameByItsKind) {
  MadeDatagram fragment;
  fragment.fragment = 0x2000;
  MadeDatagram tcp;
  tcp.protocol = 6;
  MadeDatagram contradiction;
  contradiction.extra_udp_length = 4;
  const Bytes whole = frame_with("cut");
  MadeCapture capture;
  capture.add(frame_with("a"))
      .add(ethernet(0x0806, Bytes(28)))
      .add(ethernet(kIpv4Type, fragment.ipv4()))
      .add(ethernet(kIpv4Type, tcp.ipv4()))
      .add(ethernet(0x86DD, Bytes(60)))
      .add(ethernet(kIpv4Type, contradiction.ipv4()))
      .add_cut(std::span(whole).first(whole.size() - 1), whole.size())
      .add_cut({}, whole.size())
      .add(frame_with("b"));

  EXPECT_EQ(payloads_of(capture.text()), "a b ");

  EXPECT_EQ(counters_.of(FrameKind::kUdp), 2U);
  EXPECT_EQ(counters_.of(FrameKind::kNotIp), 1U);
  EXPECT_EQ(counters_.of(FrameKind::kFragment), 1U);
  EXPECT_EQ(counters_.of(FrameKind::kNotUdp), 1U);
  EXPECT_EQ(counters_.of(FrameKind::kIpv6), 1U);
  EXPECT_EQ(counters_.of(FrameKind::kBadHeader), 1U);
  EXPECT_EQ(counters_.of(FrameKind::kTruncated), 2U);
  EXPECT_EQ(frames(), 9U);
}

TEST_F(PcapReaderTest, HandsOutForeignPortsForOthersToJudge) {
  PcapReader sut(write("capture.pcap", MadeCapture().add(frame_with("dns", 53)).add(frame_with("scan")).text()));
  Packet packet;

  ASSERT_TRUE(sut.next(packet));
  EXPECT_EQ(packet.destination_port, 53);
  ASSERT_TRUE(sut.next(packet));
  EXPECT_EQ(packet.destination_port, 2368);
  EXPECT_FALSE(sut.next(packet));
}

TEST_F(PcapReaderTest, KeepsWhatStandsBeforeATruncatedRecord) {
  const std::string one = MadeCapture().add(frame_with("one")).text();
  const std::string both = MadeCapture().add(frame_with("one")).add(frame_with("two")).text();

  for (std::size_t size = one.size(); size <= both.size(); ++size) {
    const bool whole = size == both.size();
    EXPECT_EQ(payloads_of(both.substr(0, size)), whole ? "one two " : "one ") << size;
    EXPECT_EQ(counters_.ended_in_a_record, size != one.size() && !whole) << size;
  }
}

TEST_F(PcapReaderTest, EndsAtARecordOfImpossibleLength) {
  std::string capture = MadeCapture().add(frame_with("one")).text();
  capture += recording::text_of(Written().add_zeros(8).add<std::uint32_t>(0xFFFFFFF0).add<std::uint32_t>(0xFFFFFFF0).bytes());

  EXPECT_EQ(payloads_of(capture), "one ");

  EXPECT_TRUE(counters_.ended_in_a_record);
}

TEST_F(PcapReaderTest, ReadsACaptureWithoutARecord) {
  EXPECT_EQ(payloads_of(MadeCapture().text()), "");

  EXPECT_EQ(frames(), 0U);
  EXPECT_FALSE(counters_.ended_in_a_record);
}

TEST_F(PcapReaderTest, NamesTheFileAndTheCauseOfWhatIsNoCapture) {
  const std::pair<const char*, std::string> files[] = {
      {"empty", ""},
      {"short", "\xD4\xC3\xB2\xA1\x02"},
      {"garbage", std::string(4096, 'g')},
      {"text", "time,x,y\n1,2,3\n"}};

  for (const auto& [name, text] : files) {
    const auto file = write(name, text);
    const std::string message = message_of<RecordingError>([&] { PcapReader sut(file); });

    EXPECT_EQ(message.find(file.string() + ": "), 0U) << message;
    EXPECT_GT(message.size(), file.string().size() + 5) << message;
    EXPECT_EQ(message.find(file.string(), 1), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  const auto absent = folder_ / "absent.pcap";
  EXPECT_EQ(message_of<RecordingError>([&] { PcapReader sut(absent); }),
            absent.string() + ": No such file or directory");
  EXPECT_NE(message_of<RecordingError>([&] { PcapReader sut(folder_); }), "");
}

/// The blocks of a pcapng file.
class MadePcapng {
 public:
  explicit MadePcapng(std::endian order) : order_(order), file_(order) {
    block(0x0A0D0D0A,
          Written(order).add<std::uint32_t>(0x1A2B3C4D).add<std::uint16_t>(1).add<std::uint16_t>(0).add(
              std::int64_t{-1}));
  }

  /// An interface for Ethernet whose stamps count 10^-resolution seconds.
  MadePcapng& interface(std::uint8_t resolution) {
    return block(1,
                 Written(order_)
                     .add<std::uint16_t>(1)
                     .add<std::uint16_t>(0)
                     .add<std::uint32_t>(262'144)
                     .add<std::uint16_t>(9)
                     .add<std::uint16_t>(1)
                     .add(resolution)
                     .add_zeros(3)
                     .add<std::uint32_t>(0));
  }

  MadePcapng& packet(const Bytes& frame, std::uint64_t stamp) {
    const auto size = static_cast<std::uint32_t>(frame.size());
    return block(6,
                 Written(order_)
                     .add<std::uint32_t>(0)
                     .add(static_cast<std::uint32_t>(stamp >> 32U))
                     .add(static_cast<std::uint32_t>(stamp))
                     .add(size)
                     .add(size)
                     .add_bytes(frame)
                     .add_zeros((4 - size % 4) % 4));
  }

  /// A block that readers have to pass over.
  MadePcapng& unknown() { return block(0x0BAD, Written(order_).add<std::uint32_t>(7)); }

  std::string text() const { return text_of(file_.bytes()); }

 private:
  MadePcapng& block(std::uint32_t type, const Written& body) {
    const auto length = static_cast<std::uint32_t>(12 + body.bytes().size());
    file_.add(type).add(length).add_bytes(body.bytes()).add(length);
    return *this;
  }

  std::endian order_;
  Written file_;
};

TEST_F(PcapReaderTest, ReadsPcapngOfBothOrdersAndResolutions) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    MadePcapng micro(order);
    micro.interface(6).packet(frame_with("one"), 1'700'000'000'000'001).unknown();
    micro.packet(frame_with("two"), 1'700'000'000'123'456);
    EXPECT_EQ(payloads_of(micro.text()), "one two ");
    EXPECT_EQ(last_.received.time_since_epoch(), 1'700'000'000s + 123'456us);
    EXPECT_FALSE(counters_.ended_in_a_record);

    MadePcapng nano(order);
    nano.interface(9).packet(frame_with("three"), 1'700'000'000'123'456'789);
    EXPECT_EQ(payloads_of(nano.text()), "three ");
    EXPECT_EQ(last_.received.time_since_epoch(), 1'700'000'000s + 123'456'789ns);
  }
}

TEST_F(PcapReaderTest, KeepsWhatStandsBeforeATruncatedBlockOfPcapng) {
  MadePcapng capture(std::endian::little);
  capture.interface(6).packet(frame_with("one"), 1).packet(frame_with("two"), 2);
  const std::string text = capture.text();

  EXPECT_EQ(payloads_of(text.substr(0, text.size() - 6)), "one ");

  EXPECT_TRUE(counters_.ended_in_a_record);
}

TEST_F(PcapReaderTest, RefusesStampsThatNoClockCanShow) {
  MadePcapng capture(std::endian::little);
  capture.interface(0).packet(frame_with("never"), 0xFFFF'FFFF'FFFFULL);
  capture.packet(frame_with("now"), 1'700'000'000);

  EXPECT_EQ(payloads_of(capture.text()), "now ");

  EXPECT_EQ(counters_.of(FrameKind::kBadStamp), 1U);
  EXPECT_EQ(last_.received.time_since_epoch(), 1'700'000'000s);
}

class PcapWriterTest : public ScratchFolder {};

TEST_F(PcapWriterTest, IsReadBackToTheNanosecondAndTheByte) {
  std::mt19937_64 random(1);
  std::vector<Bytes> payloads;
  std::vector<Packet> written;
  for (const std::size_t size : {0U, 1U, 2U, 1206U, 1207U, 1472U, 9000U, 65'507U}) {
    Bytes payload(size);
    for (std::byte& byte : payload) {
      byte = static_cast<std::byte>(random());
    }
    payloads.push_back(payload);
  }
  for (const Bytes& payload : payloads) {
    Packet packet;
    packet.received = Stamp{1'700'000'000'999'999'999ns + Duration(written.size())};
    packet.source_address = 0xC0A801C9;
    packet.source_port = static_cast<std::uint16_t>(random());
    packet.destination_port = static_cast<std::uint16_t>(random());
    packet.payload = payload;
    written.push_back(packet);
  }
  PcapWriter sut(folder_ / "out.pcap");

  for (const Packet& packet : written) {
    sut.write(packet);
  }
  sut.close();

  PcapReader reader(folder_ / "out.pcap");
  Packet read;
  for (const Packet& packet : written) {
    ASSERT_TRUE(reader.next(read)) << packet.payload.size();
    EXPECT_EQ(read.received, packet.received);
    EXPECT_EQ(read.source_address, packet.source_address);
    EXPECT_EQ(read.source_port, packet.source_port);
    EXPECT_EQ(read.destination_port, packet.destination_port);
    EXPECT_TRUE(std::equal(read.payload.begin(), read.payload.end(), packet.payload.begin(), packet.payload.end()));
  }
  EXPECT_FALSE(reader.next(read));
  EXPECT_FALSE(reader.counters().ended_in_a_record);
}

TEST_F(PcapWriterTest, RefusesAPayloadThatNoDatagramHolds) {
  PcapWriter sut(folder_ / "out.pcap");
  const Bytes payload(65'508);
  Packet packet;
  packet.payload = payload;

  EXPECT_NE(message_of<RecordingError>([&] { sut.write(packet); }), "");
  sut.close();

  EXPECT_EQ(std::filesystem::file_size(folder_ / "out.pcap"), 24U);
}

/// Ones' complement sum of big-endian words; 0xFFFF over data that hold their own right checksum.
std::uint32_t folded_sum(std::span<const std::byte> bytes, std::uint32_t sum = 0) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    sum += std::to_integer<std::uint32_t>(bytes[i]) << (i % 2 == 0 ? 8U : 0U);
  }
  while (sum > 0xFFFF) {
    sum = (sum & 0xFFFF) + (sum >> 16U);
  }
  return sum;
}

TEST_F(PcapWriterTest, WritesFramesWithValidChecksums) {
  const Bytes payload = bytes_of("an odd number of bytes.");
  ASSERT_EQ(payload.size() % 2, 1U);
  Packet packet;
  packet.source_address = 0xC0A801C9;
  packet.source_port = 2368;
  packet.destination_port = 2369;
  packet.payload = payload;
  PcapWriter sut(folder_ / "out.pcap");

  sut.write(packet, 0xC0A80164);
  sut.close();

  std::ifstream stream(folder_ / "out.pcap", std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  const Bytes file = bytes_of(text);
  ASSERT_EQ(file.size(), 24 + 16 + 42 + payload.size());
  const auto frame = std::span(file).subspan(40);
  EXPECT_EQ(load_be<std::uint16_t>(frame, 12), kIpv4Type);
  EXPECT_EQ(load_be<std::uint32_t>(frame, 30), 0xC0A80164U);
  EXPECT_EQ(folded_sum(frame.subspan(14, 20)), 0xFFFFU);
  const auto udp = frame.subspan(34);
  const auto pseudo = 17 + static_cast<std::uint32_t>(udp.size());
  EXPECT_NE(load_be<std::uint16_t>(udp, 6), 0);
  EXPECT_EQ(folded_sum(udp, folded_sum(frame.subspan(26, 8), pseudo)), 0xFFFFU);
}

// A checksum of 0 would say that there is none (RFC 768).
TEST_F(PcapWriterTest, WritesAChecksumOfZeroAsAllOnes) {
  Packet packet;
  packet.source_address = 0x0A000001;
  packet.source_port = 0xFFFF - 0x0A00 - 0x0002 - 17 - 8 - 8;  // what all the other words leave
  PcapWriter sut(folder_ / "out.pcap");

  sut.write(packet, 0x00000001);
  sut.close();

  std::ifstream stream(folder_ / "out.pcap", std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  ASSERT_EQ(text.size(), 24U + 16 + 42);
  EXPECT_EQ(text.substr(text.size() - 2), "\xFF\xFF");
}

TEST_F(PcapWriterTest, TellsWhenTheFileCannotBeWritten) {
  const auto nowhere = folder_ / "no" / "such" / "folder.pcap";
  EXPECT_EQ(message_of<RecordingError>([&] { PcapWriter sut(nowhere); }),
            nowhere.string() + ": No such file or directory");

  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "/dev/full is not there";
  }
  PcapWriter sut("/dev/full");
  Packet packet;
  sut.write(packet);
  EXPECT_EQ(message_of<RecordingError>([&] { sut.close(); }).find("/dev/full: could not be written whole"), 0U);
}

TEST_F(PcapWriterTest, ClosesTwiceAsOnce) {
  PcapWriter sut(folder_ / "out.pcap");

  sut.close();
  sut.close();

  PcapReader reader(folder_ / "out.pcap");
  Packet packet;
  EXPECT_FALSE(reader.next(packet));
}

}  // namespace
}  // namespace slamd::recording
