#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.hpp"

namespace slamd::recording {

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Appends numbers and bytes, in either order.
class Written {
 public:
  explicit Written(std::endian order = std::endian::little) : order_(order) {}

  template <typename T>
  Written& add(T value) {
    bytes_.resize(bytes_.size() + sizeof(T));
    if (order_ == std::endian::little) {
      store_le(std::span(bytes_), bytes_.size() - sizeof(T), value);
    } else {
      store_be(std::span(bytes_), bytes_.size() - sizeof(T), value);
    }
    return *this;
  }

  Written& add_bytes(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }

  Written& add_zeros(std::size_t count) {
    bytes_.resize(bytes_.size() + count);
    return *this;
  }

  const Bytes& bytes() const { return bytes_; }

 private:
  std::endian order_;
  Bytes bytes_;
};

/// A UDP datagram in IPv4, with whatever a test wants to be wrong about it.
struct MadeDatagram {
  Bytes payload = bytes_of("payload");
  std::uint16_t source_port = 1000;
  std::uint16_t destination_port = 2368;
  std::size_t option_words = 0;      // of four bytes
  std::uint8_t protocol = 17;
  std::uint16_t fragment = 0x4000;   // don't fragment
  int extra_ip_length = 0;           // beyond the truth
  int extra_udp_length = 0;

  Bytes ipv4() const {
    const std::size_t header = 20 + 4 * option_words;
    const auto udp_length = static_cast<int>(8 + payload.size());
    const int total = static_cast<int>(header) + udp_length;
    Written ip(std::endian::big);
    ip.add(static_cast<std::uint8_t>(0x40 + header / 4)).add<std::uint8_t>(0);
    ip.add(static_cast<std::uint16_t>(total + extra_ip_length)).add<std::uint16_t>(1).add(fragment);
    ip.add<std::uint8_t>(64).add(protocol).add<std::uint16_t>(0);
    ip.add<std::uint32_t>(0xC0A801C9).add<std::uint32_t>(0xFFFFFFFF).add_zeros(4 * option_words);
    ip.add(source_port).add(destination_port).add(static_cast<std::uint16_t>(udp_length + extra_udp_length));
    ip.add<std::uint16_t>(0).add_bytes(payload);
    return ip.bytes();
  }
};

inline Bytes ethernet(std::uint16_t type, std::span<const std::byte> rest, std::size_t vlan_tags = 0) {
  Written frame(std::endian::big);
  frame.add_zeros(12);
  for (std::size_t i = 0; i < vlan_tags; ++i) {
    frame.add<std::uint16_t>(i + 1 < vlan_tags ? 0x88A8 : 0x8100).add<std::uint16_t>(7);
  }
  return frame.add(type).add_bytes(rest).bytes();
}

/// A classic capture of one link layer.
class MadeCapture {
 public:
  enum class Stamps : std::uint32_t { kMicroseconds = 0xA1B2C3D4, kNanoseconds = 0xA1B23C4D };

  explicit MadeCapture(std::uint32_t link = 1,
                       Stamps stamps = Stamps::kMicroseconds,
                       std::endian order = std::endian::little)
      : file_(order) {
    file_.add(static_cast<std::uint32_t>(stamps)).add<std::uint16_t>(2).add<std::uint16_t>(4).add_zeros(8);
    file_.add<std::uint32_t>(262'144).add(link);
  }

  MadeCapture& add(std::span<const std::byte> frame, std::uint32_t seconds = 1, std::uint32_t fraction = 0) {
    return add_cut(frame, frame.size(), seconds, fraction);
  }

  /// A frame of which the capture kept less.
  MadeCapture& add_cut(std::span<const std::byte> kept,
                       std::size_t length,
                       std::uint32_t seconds = 1,
                       std::uint32_t fraction = 0) {
    file_.add(seconds).add(fraction);
    file_.add(static_cast<std::uint32_t>(kept.size())).add(static_cast<std::uint32_t>(length)).add_bytes(kept);
    return *this;
  }

  std::string text() const { return text_of(file_.bytes()); }

 private:
  Written file_;
};

}  // namespace slamd::recording
