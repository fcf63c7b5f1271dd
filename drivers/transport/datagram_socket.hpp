#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace slamd::transport {

inline constexpr std::uint32_t kBroadcastAddress = 0xFFFFFFFF;  // 255.255.255.255

/// Sends and receives datagrams that are few: commands, answers, broadcasts. For data there is UdpReceiver.
/// What the network does not take (no route, interface down) is lost, as on the wire. Addresses in host order.
/// Threads: one.  Real-time: no; never blocks.
class DatagramSocket {
 public:
  enum class Sharing { kAlone, kWithOthers };  // others on this host may listen to the same port

  /// Binds a port on all addresses of this host. Errors: TransportError: taken (by whom), no permission.
  explicit DatagramSocket(std::uint16_t port, Sharing sharing = Sharing::kAlone);
  ~DatagramSocket();
  DatagramSocket(const DatagramSocket&) = delete;
  DatagramSocket& operator=(const DatagramSocket&) = delete;

  struct Received {
    std::span<const std::byte> payload;  // valid until the next call
    std::uint32_t address = 0;
    std::uint16_t port = 0;
  };

  /// Takes a datagram that waits, if there is one.
  std::optional<Received> receive();

  /// Sends to an address, or with kBroadcastAddress to everybody on each interface; tells whether the network took it.
  bool send(std::span<const std::byte> payload, std::uint32_t address, std::uint16_t port);

  int fd() const { return fd_; }
  std::uint16_t port() const { return port_; }

 private:
  bool send_by(unsigned interface_index, std::span<const std::byte> payload, std::uint32_t address, std::uint16_t port);

  int fd_ = -1;
  std::uint16_t port_ = 0;
  std::array<std::byte, 2048> buffer_{};
};

}  // namespace slamd::transport
