#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/recording/packet.hpp"

namespace slamd::recording {

/// What a captured frame turned out to be. (kBadStamp is found by the reader of the capture.)
enum class FrameKind : std::uint8_t {
  kUdp,
  kFragment,        // part of a fragmented datagram: reported, not guessed at
  kTruncated,       // the capture kept less than the headers say
  kNotIp,           // ARP and the like
  kIpv6,
  kNotUdp,
  kBadHeader,       // lengths contradict each other
  kUnknownLink,     // a link layer that is not read
  kBadStamp,        // a datagram, but received after the year 2261
};

inline constexpr std::size_t kFrameKinds = 9;

const char* name_of(FrameKind kind);

/// Link layers, by libpcap's DLT numbers.
inline constexpr int kLinkNull = 0;
inline constexpr int kLinkEthernet = 1;
inline constexpr int kLinkRaw = 12;
inline constexpr int kLinkRawOther = 101;
inline constexpr int kLinkLoop = 108;
inline constexpr int kLinkCooked = 113;
inline constexpr int kLinkCooked2 = 276;
inline constexpr int kLinkIpv4 = 228;

/// Finds the UDP payload in a captured frame: Ethernet with any number of VLAN tags, Linux cooked (1 and 2), raw IP,
/// null and loopback. Fills ports, address and payload of `packet` when the result is kUdp.
/// `length` is the frame's length on the wire. An IP length beyond it is passed over when the UDP length fits.
/// Real-time: no allocation.
FrameKind parse_frame(int link, std::span<const std::byte> frame, std::size_t length, Packet& packet);

}  // namespace slamd::recording
