#include "drivers/recording/pcap_writer.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include "core/base/bytes.hpp"

namespace slamd::recording {

namespace {

constexpr std::size_t kEthernet = 14;
constexpr std::size_t kIp = 20;
constexpr std::size_t kUdp = 8;
constexpr std::size_t kHeaders = kEthernet + kIp + kUdp;
constexpr std::size_t kMaxPayload = 65535 - kIp - kUdp;

/// Ones' complement sum of 16-bit words (RFC 1071).
std::uint32_t sum_of(std::span<const std::byte> bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    sum += load_be<std::uint16_t>(bytes, i);
  }
  if (bytes.size() % 2 != 0) {
    sum += static_cast<std::uint32_t>(bytes.back()) << 8;
  }
  return sum;
}

std::uint16_t checksum(std::uint32_t sum) {
  while (sum >> 16 != 0) {
    sum = (sum & 0xFFFF) + (sum >> 16);
  }
  return static_cast<std::uint16_t>(~sum);
}

}  // namespace

PcapWriter::PcapWriter(const std::filesystem::path& file) : file_(file), stream_(std::fopen(file.c_str(), "wb"), std::fclose) {
  if (!stream_) {
    throw RecordingError(file, std::strerror(errno));
  }
  std::array<std::byte, 24> header{};
  store_le<std::uint32_t>(header, 0, 0xA1B23C4D);  // nanosecond stamps
  store_le<std::uint16_t>(header, 4, 2);
  store_le<std::uint16_t>(header, 6, 4);
  store_le<std::uint32_t>(header, 16, kHeaders + kMaxPayload);  // none is cut
  store_le<std::uint32_t>(header, 20, 1);  // Ethernet
  std::fwrite(header.data(), 1, header.size(), stream_.get());
}

void PcapWriter::write(const Packet& packet, std::uint32_t destination_address) {
  if (packet.payload.size() > kMaxPayload) {
    throw RecordingError(file_, "a payload of " + std::to_string(packet.payload.size()) + " bytes is no datagram's");
  }
  std::array<std::byte, 16 + kHeaders> bytes{};
  const std::size_t length = kHeaders + packet.payload.size();
  const std::int64_t ns = packet.received.time_since_epoch().count();
  store_le(bytes, 0, static_cast<std::uint32_t>(ns / 1'000'000'000));
  store_le(bytes, 4, static_cast<std::uint32_t>(ns % 1'000'000'000));
  store_le(bytes, 8, static_cast<std::uint32_t>(length));
  store_le(bytes, 12, static_cast<std::uint32_t>(length));

  const std::span<std::byte> frame = std::span(bytes).subspan(16);
  for (std::size_t i = 0; i < 6; ++i) {
    frame[i] = std::byte{0xFF};
    frame[6 + i] = std::byte{static_cast<unsigned char>(i == 0 ? 0x02 : i)};  // a local address
  }
  store_be<std::uint16_t>(frame, 12, 0x0800);
  const std::span<std::byte> ip = frame.subspan(kEthernet);
  ip[0] = std::byte{0x45};
  store_be(ip, 2, static_cast<std::uint16_t>(length - kEthernet));
  store_be<std::uint16_t>(ip, 6, 0x4000);  // don't fragment
  ip[8] = std::byte{64};
  ip[9] = std::byte{17};
  store_be(ip, 12, packet.source_address);
  store_be(ip, 16, destination_address);
  store_be(ip, 10, checksum(sum_of(ip.first(kIp), 0)));
  const std::span<std::byte> udp = ip.subspan(kIp);
  const auto udp_length = static_cast<std::uint16_t>(kUdp + packet.payload.size());
  store_be(udp, 0, packet.source_port);
  store_be(udp, 2, packet.destination_port);
  store_be(udp, 4, udp_length);
  const std::uint32_t pseudo = sum_of(ip.subspan(12, 8), 17U + udp_length);
  const std::uint16_t check = checksum(sum_of(packet.payload, sum_of(udp.first(kUdp), pseudo)));
  store_be(udp, 6, check == 0 ? std::uint16_t{0xFFFF} : check);

  std::fwrite(bytes.data(), 1, bytes.size(), stream_.get());
  if (!packet.payload.empty()) {  // an empty one may be a null pointer, which fwrite must not see
    std::fwrite(packet.payload.data(), 1, packet.payload.size(), stream_.get());
  }
}

void PcapWriter::close() {
  if (!stream_) {
    return;
  }
  const bool failed = std::ferror(stream_.get()) != 0;
  if (std::fclose(stream_.release()) != 0 || failed) {
    throw RecordingError(file_, "could not be written whole: " + std::string(std::strerror(errno)));
  }
}

}  // namespace slamd::recording
