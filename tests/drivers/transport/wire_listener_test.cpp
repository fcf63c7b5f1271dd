#include "drivers/transport/wire_listener.hpp"

#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/bytes.hpp"
#include "drivers/transport/datagram_socket.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {
namespace {

using Bytes = std::vector<std::byte>;

/// 192.168.1.201:2368 to everybody:2368, "abc", with an IP header of so many words of 32 bits.
Bytes packet(std::size_t words = 5) {
  const std::size_t header = 4 * words;
  Bytes bytes(header + 11);
  store_be(bytes, 0, static_cast<std::uint8_t>(0x40U | words));
  store_be(bytes, 2, static_cast<std::uint16_t>(bytes.size()));
  store_be<std::uint8_t>(bytes, 9, 17);
  store_be<std::uint32_t>(bytes, 12, 0xC0A801C9);
  store_be<std::uint32_t>(bytes, 16, 0xFFFFFFFF);
  store_be<std::uint16_t>(bytes, header, 2368);
  store_be<std::uint16_t>(bytes, header + 2, 2369);
  store_be<std::uint16_t>(bytes, header + 4, 11);
  bytes[header + 8] = std::byte{'a'};
  bytes[header + 9] = std::byte{'b'};
  bytes[header + 10] = std::byte{'c'};
  return bytes;
}

TEST(WireDatagram, IsReadWithItsAddressesAndPorts) {
  for (const std::size_t words : {5U, 15U}) {
    const Bytes bytes = packet(words);

    const auto sut = parse_udp(bytes);

    ASSERT_TRUE(sut) << words;
    EXPECT_EQ(sut->source_address, 0xC0A801C9U);
    EXPECT_EQ(sut->destination_address, 0xFFFFFFFFU);
    EXPECT_EQ(sut->source_port, 2368);
    EXPECT_EQ(sut->destination_port, 2369);
    ASSERT_EQ(sut->payload.size(), 3U);
    EXPECT_EQ(sut->payload[2], std::byte{'c'});
  }
}

TEST(WireDatagram, LeavesOutWhatFollowsThePacket) {
  Bytes bytes = packet();
  bytes.resize(60);  // the least that Ethernet carries

  EXPECT_EQ(parse_udp(bytes)->payload.size(), 3U);
}

TEST(WireDatagram, IsNoneOfAnotherProtocolVersionOrInPieces) {
  for (const auto& [at, value] : {std::pair<std::size_t, std::uint8_t>{9, 6}, {0, 0x65}, {0, 0x44}, {6, 0x20}, {7, 0x01}}) {
    Bytes bytes = packet();
    store_be(bytes, at, value);

    EXPECT_FALSE(parse_udp(bytes)) << at;
  }
}

TEST(WireDatagram, IsNoneWhereLengthsContradict) {
  const Bytes good = packet();
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(parse_udp(std::span(good).first(size))) << size;
  }
  for (const std::uint16_t udp_bytes : {0, 7, 12, 0xFFFF}) {
    Bytes bytes = good;
    store_be(bytes, 24, udp_bytes);
    EXPECT_FALSE(parse_udp(bytes)) << udp_bytes;
  }
  std::mt19937 random(2);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes(random() % 64);
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(random());
    }
    if (!bytes.empty()) {
      bytes[0] = std::byte{0x45};
    }
    if (const auto sut = parse_udp(bytes)) {
      EXPECT_LE(sut->payload.size(), bytes.size());
    }
  }
}

TEST(WireListener, HearsWhatIsMeantForOthersAndTakesNothingFromThem) {
  std::unique_ptr<WireListener> sut;
  try {
    sut = std::make_unique<WireListener>();
  } catch (const TransportError& error) {
    GTEST_SKIP() << error.what();
  }
  DatagramSocket receiver(0);
  DatagramSocket sender(0);
  const std::byte payload[] = {std::byte{1}, std::byte{2}};

  ASSERT_TRUE(sender.send(payload, 0x7F000001, receiver.port()));

  int heard = 0;
  for (int i = 0; i < 100 && heard == 0; ++i) {
    while (const auto datagram = sut->receive()) {
      heard += datagram->destination_port == receiver.port() && datagram->payload.size() == 2 ? 1 : 0;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_EQ(heard, 1);  // once, though it goes out and comes in
  EXPECT_TRUE(receiver.receive());
}

}  // namespace
}  // namespace slamd::transport
