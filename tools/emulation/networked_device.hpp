#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/transport/datagram_socket.hpp"
#include "tools/emulation/device.hpp"

namespace slamd::emulation {

/// Plays a device on the network: sockets around its side of the protocol. What the network does not take is lost, as
/// from a device whose cable is out.
/// Threads: one.
class NetworkedDevice {
 public:
  /// Errors: transport::TransportError when a port is taken. `say` hears the news.
  NetworkedDevice(std::unique_ptr<Device> device, std::function<void(const std::string&)> say);

  /// Answers, and does what is due; to be called every few milliseconds.
  void serve(Stamp now);

  /// Sends a packet where the device's host wants it. Returns false when nobody does, or the network does not take it.
  bool send(Stream stream, std::span<const std::byte> payload);

 private:
  transport::DatagramSocket& socket(std::uint16_t port);
  void hand_out();

  std::unique_ptr<Device> device_;
  std::function<void(const std::string&)> say_;
  std::vector<std::unique_ptr<transport::DatagramSocket>> sockets_;
  DeviceOutput out_;
};

}  // namespace slamd::emulation
