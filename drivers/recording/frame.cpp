#include "drivers/recording/frame.hpp"

#include <algorithm>
#include <optional>

#include "core/base/bytes.hpp"
#include "drivers/transport/ipv4.hpp"

namespace slamd::recording {

namespace {

constexpr std::uint16_t kEtherIpv4 = 0x0800;
constexpr std::uint16_t kEtherIpv6 = 0x86DD;

bool is_vlan(std::uint16_t type) { return type == 0x8100 || type == 0x88A8 || type == 0x9100; }

/// The network layer inside a frame: where it begins, and its EtherType.
struct Network {
  std::size_t offset = 0;
  std::uint16_t type = 0;
};

std::optional<Network> after_ether_type(std::span<const std::byte> frame, std::size_t type_offset) {
  while (frame.size() >= type_offset + 2) {
    const auto type = load_be<std::uint16_t>(frame, type_offset);
    if (!is_vlan(type)) {
      return Network{type_offset + 2, type};
    }
    type_offset += 4;
  }
  return std::nullopt;
}

std::optional<Network> by_ip_version(std::span<const std::byte> frame, std::size_t offset) {
  if (frame.size() <= offset) {
    return std::nullopt;
  }
  const int version = static_cast<int>(frame[offset]) >> 4;
  return Network{offset, version == 4 ? kEtherIpv4 : (version == 6 ? kEtherIpv6 : std::uint16_t{0})};
}

bool knows(int link) {
  return link == kLinkEthernet || link == kLinkCooked || link == kLinkCooked2 || link == kLinkRaw ||
         link == kLinkRawOther || link == kLinkIpv4 || link == kLinkNull || link == kLinkLoop;
}

/// Nothing when the frame ends before its link header does.
std::optional<Network> network_of(int link, std::span<const std::byte> frame) {
  switch (link) {
    case kLinkEthernet: return after_ether_type(frame, 12);
    case kLinkCooked: {
      const auto network = after_ether_type(frame, 14);
      return network;
    }
    case kLinkCooked2:
      return frame.size() < 20 ? std::nullopt
                               : std::optional(Network{20, load_be<std::uint16_t>(frame, 0)});
    case kLinkNull:
    case kLinkLoop: return by_ip_version(frame, 4);
    default: return by_ip_version(frame, 0);
  }
}

FrameKind parse_ip(std::span<const std::byte> ip, std::size_t length, Packet& packet) {
  transport::WireDatagram datagram;
  switch (transport::parse_ipv4(ip, length, datagram)) {
    case transport::Ipv4Kind::kNotUdp: return FrameKind::kNotUdp;
    case transport::Ipv4Kind::kFragment: return FrameKind::kFragment;
    case transport::Ipv4Kind::kTruncated: return FrameKind::kTruncated;
    case transport::Ipv4Kind::kBadHeader: return FrameKind::kBadHeader;
    case transport::Ipv4Kind::kUdp: break;
  }
  packet.source_address = datagram.source_address;
  packet.source_port = datagram.source_port;
  packet.destination_port = datagram.destination_port;
  packet.payload = datagram.payload;
  return FrameKind::kUdp;
}

}  // namespace

const char* name_of(FrameKind kind) {
  switch (kind) {
    case FrameKind::kUdp: return "udp";
    case FrameKind::kFragment: return "ip_fragment";
    case FrameKind::kTruncated: return "truncated_capture";
    case FrameKind::kNotIp: return "not_ip";
    case FrameKind::kIpv6: return "ipv6";
    case FrameKind::kNotUdp: return "not_udp";
    case FrameKind::kBadHeader: return "bad_ip_or_udp_header";
    case FrameKind::kUnknownLink: return "unknown_link_layer";
    case FrameKind::kBadStamp: return "bad_stamp";
  }
  return "?";
}

FrameKind parse_frame(int link, std::span<const std::byte> frame, std::size_t length, Packet& packet) {
  if (!knows(link)) {
    return FrameKind::kUnknownLink;
  }
  const std::optional<Network> network = network_of(link, frame);
  if (!network) {
    return FrameKind::kTruncated;
  }
  if (network->type == kEtherIpv6) {
    return FrameKind::kIpv6;
  }
  if (network->type != kEtherIpv4) {
    return FrameKind::kNotIp;
  }
  const std::size_t on_wire = std::max(length, frame.size());
  return parse_ip(frame.subspan(network->offset), on_wire - network->offset, packet);
}

}  // namespace slamd::recording
