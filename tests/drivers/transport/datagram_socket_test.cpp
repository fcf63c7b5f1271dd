#include "drivers/transport/datagram_socket.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include <poll.h>

#include "drivers/transport/interfaces.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {
namespace {

constexpr std::uint32_t kLoopback = 0x7F000001;

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

/// The text that comes within a second.
std::string next_text(DatagramSocket& socket, std::uint16_t& port) {
  pollfd waited{socket.fd(), POLLIN, 0};
  poll(&waited, 1, 1000);
  const auto received = socket.receive();
  port = received ? received->port : std::uint16_t{0};
  return received ? std::string(reinterpret_cast<const char*>(received->payload.data()), received->payload.size()) : "";
}

TEST(DatagramSocket, ReceivesWhatAnotherSendsAndFromWhere) {
  DatagramSocket sut(0);
  DatagramSocket other(0);

  EXPECT_TRUE(other.send(bytes_of("hello"), kLoopback, sut.port()));

  std::uint16_t from = 0;
  EXPECT_EQ(next_text(sut, from), "hello");
  EXPECT_EQ(from, other.port());
  EXPECT_FALSE(sut.receive());
}

TEST(DatagramSocket, SaysWhoHasThePort) {
  DatagramSocket first(0);

  try {
    DatagramSocket sut(first.port());
    FAIL() << "was bound twice";
  } catch (const TransportError& error) {
    EXPECT_NE(std::string(error.what()).find("UDP port " + std::to_string(first.port()) + " is taken by"),
              std::string::npos)
        << error.what();
  }
}

TEST(DatagramSocket, SharesAPortWithOthersThatDoSo) {
  DatagramSocket first(0, DatagramSocket::Sharing::kWithOthers);

  EXPECT_NO_THROW(DatagramSocket(first.port(), DatagramSocket::Sharing::kWithOthers));
}

TEST(DatagramSocket, LosesWhatTheNetworkDoesNotTake) {
  DatagramSocket sut(0);

  EXPECT_FALSE(sut.send(std::vector<std::byte>(70'000), kLoopback, sut.port()));
}

TEST(Interfaces, HoldLoopbackWithItsNetmask) {
  bool found = false;
  for (const Interface& interface : interfaces()) {
    found = found || (interface.address == kLoopback && interface.netmask == 0xFF000000 && !interface.broadcasts);
  }

  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace slamd::transport
