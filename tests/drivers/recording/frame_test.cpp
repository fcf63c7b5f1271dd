#include "drivers/recording/frame.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "made_capture.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::recording {
namespace {

constexpr std::uint16_t kIpv4Type = 0x0800;

class FrameTest : public testing::Test {
 protected:
  FrameKind parse(int link, Bytes frame) {
    frame_ = std::move(frame);
    return parse_frame(link, frame_, frame_.size(), packet_);
  }

  void expect_the_payload() const {
    EXPECT_EQ(text_of(packet_.payload), "payload");
    EXPECT_EQ(packet_.source_address, 0xC0A801C9U);
    EXPECT_EQ(packet_.source_port, 1000);
    EXPECT_EQ(packet_.destination_port, 2368);
  }

  Bytes frame_;  // what the packet's payload points into
  Packet packet_;
};

Bytes in_front(const Bytes& head, const Bytes& rest) { return Written().add_bytes(head).add_bytes(rest).bytes(); }

/// Linux cooked: packet type, hardware, address length and address, protocol.
Bytes cooked(std::uint16_t type, const Bytes& rest) {
  return Written(std::endian::big).add_zeros(14).add(type).add_bytes(rest).bytes();
}

/// Its second version: the protocol stands in front.
Bytes cooked2(std::uint16_t type, const Bytes& rest) {
  return Written(std::endian::big).add(type).add_zeros(18).add_bytes(rest).bytes();
}

TEST_F(FrameTest, FindsThePayloadInEachLinkLayer) {
  const Bytes ip = MadeDatagram{}.ipv4();
  const std::pair<int, Bytes> frames[] = {{kLinkEthernet, ethernet(kIpv4Type, ip)},
                                          {kLinkCooked, cooked(kIpv4Type, ip)},
                                          {kLinkCooked2, cooked2(kIpv4Type, ip)},
                                          {kLinkRaw, ip},
                                          {kLinkRawOther, ip},
                                          {kLinkIpv4, ip},
                                          {kLinkNull, in_front(Bytes(4), ip)},
                                          {kLinkLoop, in_front(Bytes(4), ip)}};

  for (const auto& [link, frame] : frames) {
    packet_ = Packet{};
    EXPECT_EQ(parse(link, frame), FrameKind::kUdp) << link;
    expect_the_payload();
  }
}

TEST_F(FrameTest, PassesOverVlanTags) {
  const Bytes ip = MadeDatagram{}.ipv4();

  for (std::size_t tags = 0; tags < 4; ++tags) {
    packet_ = Packet{};
    EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, ip, tags)), FrameKind::kUdp) << tags;
    expect_the_payload();
  }
}

TEST_F(FrameTest, PassesOverOptionsOfEveryLength) {
  for (std::size_t words = 0; words <= 10; ++words) {
    MadeDatagram datagram;
    datagram.option_words = words;
    packet_ = Packet{};

    EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, datagram.ipv4())), FrameKind::kUdp) << words;

    expect_the_payload();
  }
}

TEST_F(FrameTest, LeavesThePaddingOfShortFramesOut) {
  Bytes frame = ethernet(kIpv4Type, MadeDatagram{}.ipv4());
  frame.resize(60, std::byte{0xEE});

  EXPECT_EQ(parse(kLinkEthernet, frame), FrameKind::kUdp);

  expect_the_payload();
}

TEST_F(FrameTest, TakesADatagramWithoutPayload) {
  MadeDatagram datagram;
  datagram.payload.clear();

  EXPECT_EQ(parse(kLinkRaw, datagram.ipv4()), FrameKind::kUdp);

  EXPECT_TRUE(packet_.payload.empty());
}

TEST_F(FrameTest, ReportsFragments) {
  MadeDatagram first;
  first.fragment = 0x2000;  // more to come
  MadeDatagram later;
  later.fragment = 185;
  MadeDatagram last_allowed;
  last_allowed.fragment = 0x8000;  // the reserved bit says nothing about fragments

  EXPECT_EQ(parse(kLinkRaw, first.ipv4()), FrameKind::kFragment);
  EXPECT_EQ(parse(kLinkRaw, later.ipv4()), FrameKind::kFragment);
  EXPECT_EQ(parse(kLinkRaw, last_allowed.ipv4()), FrameKind::kUdp);
}

TEST_F(FrameTest, TellsWhatIsNoUdpDatagram) {
  MadeDatagram tcp;
  tcp.protocol = 6;
  Bytes ipv6(60);
  ipv6[0] = std::byte{0x60};
  Bytes neither(60);
  neither[0] = std::byte{0x10};

  EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, tcp.ipv4())), FrameKind::kNotUdp);
  EXPECT_EQ(parse(kLinkEthernet, ethernet(0x0806, Bytes(28))), FrameKind::kNotIp);  // ARP
  EXPECT_EQ(parse(kLinkEthernet, ethernet(0x0026, Bytes(38))), FrameKind::kNotIp);  // a length, not a type
  EXPECT_EQ(parse(kLinkEthernet, ethernet(0x86DD, ipv6)), FrameKind::kIpv6);
  EXPECT_EQ(parse(kLinkRaw, ipv6), FrameKind::kIpv6);
  EXPECT_EQ(parse(kLinkRaw, neither), FrameKind::kNotIp);
  EXPECT_EQ(parse(147, ethernet(kIpv4Type, MadeDatagram{}.ipv4())), FrameKind::kUnknownLink);
}

TEST_F(FrameTest, RefusesLengthsThatContradictEachOther) {
  MadeDatagram short_ip;
  short_ip.extra_ip_length = -1;
  MadeDatagram no_room_for_udp;
  no_room_for_udp.extra_ip_length = -8;
  MadeDatagram long_udp;
  long_udp.extra_udp_length = 1;
  MadeDatagram tiny_udp;
  tiny_udp.extra_udp_length = -8;
  Bytes short_header = MadeDatagram{}.ipv4();
  short_header[0] = std::byte{0x44};
  Bytes version = MadeDatagram{}.ipv4();
  version[0] = std::byte{0x55};

  for (const MadeDatagram& datagram : {short_ip, no_room_for_udp, long_udp, tiny_udp}) {
    EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, datagram.ipv4())), FrameKind::kBadHeader);
  }
  EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, short_header)), FrameKind::kBadHeader);
  EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, version)), FrameKind::kBadHeader);
}

// Early VLP-16 firmware sends its position packets with the IP length of its data packets.
TEST_F(FrameTest, PassesOverAnIpLengthBeyondTheFrameWhenTheDatagramFits) {
  MadeDatagram beyond;
  beyond.extra_ip_length = 694;
  MadeDatagram both_beyond = beyond;
  both_beyond.extra_udp_length = 1;

  EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, beyond.ipv4())), FrameKind::kUdp);
  expect_the_payload();
  EXPECT_EQ(parse(kLinkEthernet, ethernet(kIpv4Type, both_beyond.ipv4())), FrameKind::kBadHeader);
}

TEST_F(FrameTest, TellsEveryTruncationOfACapture) {
  const Bytes frame = ethernet(kIpv4Type, MadeDatagram{}.ipv4(), 1);

  for (std::size_t kept = 0; kept < frame.size(); ++kept) {
    const auto cut = std::span(frame).first(kept);
    EXPECT_EQ(parse_frame(kLinkEthernet, cut, frame.size(), packet_), FrameKind::kTruncated) << kept;
  }
  EXPECT_EQ(packet_.payload.data(), nullptr);
}

TEST_F(FrameTest, SurvivesAWireLengthShorterThanWhatWasKept) {
  const Bytes frame = ethernet(kIpv4Type, MadeDatagram{}.ipv4());

  for (std::size_t length = 0; length < frame.size(); ++length) {
    EXPECT_EQ(parse_frame(kLinkEthernet, frame, length, packet_), FrameKind::kUdp) << length;
  }
}

TEST_F(FrameTest, NamesEveryKindDifferently) {
  std::set<std::string> names;
  for (std::size_t kind = 0; kind < kFrameKinds; ++kind) {
    names.insert(name_of(static_cast<FrameKind>(kind)));
  }

  EXPECT_EQ(names.size(), kFrameKinds);
  EXPECT_EQ(names.count("?"), 0U);
}

TEST_F(FrameTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  frame_ = ethernet(kIpv4Type, MadeDatagram{}.ipv4(), 2);

  const std::size_t count =
      support::count_allocations([&] { parse_frame(kLinkEthernet, frame_, frame_.size(), packet_); });

  EXPECT_EQ(count, 0U);
  expect_the_payload();
}

TEST_F(FrameTest, KeepsEveryPayloadInsideItsFrameWhateverTheBytes) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    MadeDatagram datagram;
    datagram.option_words = random() % 3;
    Bytes frame = ethernet(kIpv4Type, datagram.ipv4(), random() % 2);
    for (std::size_t i = random() % 5; i > 0; --i) {
      frame[random() % frame.size()] = static_cast<std::byte>(random());
    }
    frame.resize(random() % 4 == 0 ? random() % frame.size() : frame.size());
    const std::size_t length = random() % 4 == 0 ? random() % 2000 : frame.size();
    const int links[] = {kLinkEthernet, kLinkCooked, kLinkCooked2, kLinkRaw, kLinkNull};
    Packet packet;

    const FrameKind kind = parse_frame(links[random() % 5 == 0 ? random() % 5 : 0], frame, length, packet);

    if (kind == FrameKind::kUdp) {
      RC_ASSERT(packet.payload.data() >= frame.data());
      RC_ASSERT(packet.payload.data() + packet.payload.size() <= frame.data() + frame.size());
    } else {
      RC_ASSERT(packet.payload.data() == nullptr);
    }
  }));
}

}  // namespace
}  // namespace slamd::recording
