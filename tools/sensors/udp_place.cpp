#include "tools/sensors/udp_place.hpp"

#include "drivers/transport/port_owner.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::sensors {

namespace {

// At once: whatever floods a port, the others have their turn.
constexpr int kMostBatches = 32;
constexpr int kMostDatagrams = 64;

}  // namespace

UdpPlace::UdpPlace(std::uint16_t port, std::string purpose, Kind kind, const transport::HostClock& clock)
    : kind_(kind), clock_(clock) {
  seen_.port = port;
  seen_.purpose = std::move(purpose);
  attend();
}

void UdpPlace::attend() {
  if (kind_ == Kind::kBroadcasts && seen_.port != 0) {
    seen_.beside = transport::other_owner_of_port(seen_.port);
  }
  if (is_open()) {
    return;
  }
  seen_.owner = kind_ == Kind::kBroadcasts ? "" : transport::owner_of_port(seen_.port);
  if (!seen_.owner.empty()) {
    return;
  }
  try {
    if (kind_ == Kind::kData) {
      data_ = std::make_unique<transport::UdpReceiver>(transport::UdpReceiverConfig{.port = seen_.port, .source_address = {}}, clock_);
      seen_.buffer = data_->buffer_remark();
    } else {
      datagrams_ = std::make_unique<transport::DatagramSocket>(seen_.port, transport::DatagramSocket::Sharing::kWithOthers);
    }
  } catch (const transport::TransportError&) {
    seen_.owner = transport::owner_of_port(seen_.port);
    seen_.owner = seen_.owner.empty() ? "another process" : seen_.owner;
  }
}

void UdpPlace::run_once(NetworkWatch& network, std::span<const transport::Interface> own) {
  for (int i = 0; data_ && i < kMostBatches; ++i) {
    const std::size_t taken = data_->receive([&](const transport::Datagram& datagram) {
      take({datagram.payload, datagram.source_address, seen_.port, datagram.received}, network, own);
    });
    if (taken == 0) {
      break;
    }
  }
  for (int i = 0; datagrams_ && i < kMostDatagrams; ++i) {
    const auto datagram = datagrams_->receive();
    if (!datagram) {
      break;
    }
    take({datagram->payload, datagram->address, seen_.port, clock_.now()}, network, own);
  }
}

void UdpPlace::take(const Arrival& arrival, NetworkWatch& network, std::span<const transport::Interface> own) {
  count_.add();
  if (!network.take(arrival, own)) {
    strange_.add();
    seen_.stranger = arrival.source;
  }
}

bool UdpPlace::send(std::span<const std::byte> payload, std::uint32_t address, std::uint16_t port) {
  return datagrams_ && datagrams_->send(payload, address, port);
}

void UdpPlace::end_second() {
  count_.end_second();
  strange_.end_second();
}

PortSeen UdpPlace::seen() const {
  PortSeen seen = seen_;
  seen.datagrams = count_.count();
  seen.strange = strange_.count();
  seen.lost = data_ ? data_->counters().kernel_lost : 0;
  return seen;
}

}  // namespace slamd::sensors
