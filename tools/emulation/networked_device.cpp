#include "tools/emulation/networked_device.hpp"

namespace slamd::emulation {

NetworkedDevice::NetworkedDevice(std::unique_ptr<Device> device, std::function<void(const std::string&)> say)
    : device_(std::move(device)), say_(std::move(say)) {
  for (const std::uint16_t port : device_->ports()) {
    sockets_.push_back(std::make_unique<transport::DatagramSocket>(port));
  }
}

void NetworkedDevice::serve(Stamp now) {
  for (const auto& socket : sockets_) {
    while (const auto datagram = socket->receive()) {
      device_->receive(datagram->payload, {datagram->address, datagram->port}, socket->port(), now, out_);
      hand_out();
    }
  }
  device_->advance(now, out_);
  hand_out();
}

bool NetworkedDevice::send(Stream stream, std::span<const std::byte> payload) {
  const auto to = device_->destination(stream);
  return to && socket(device_->source_port(stream)).send(payload, to->address, to->port);
}

transport::DatagramSocket& NetworkedDevice::socket(std::uint16_t port) {
  for (const auto& socket : sockets_) {
    if (socket->port() == port) {
      return *socket;
    }
  }
  return *sockets_.front();
}

void NetworkedDevice::hand_out() {
  for (const DeviceOutput::Datagram& datagram : out_.datagrams) {
    socket(datagram.from_port).send(datagram.bytes.view(), datagram.to.address, datagram.to.port);
  }
  for (const std::string& text : out_.news) {
    say_(text);
  }
  out_.clear();
}

}  // namespace slamd::emulation
