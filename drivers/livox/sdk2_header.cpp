#include "drivers/livox/sdk2_header.hpp"

#include <algorithm>

#include "core/base/bytes.hpp"
#include "core/base/crc32.hpp"

namespace slamd::livox {

Sdk2Header parse_sdk2_header(std::span<const std::byte> payload) {
  Sdk2Header header;
  header.version = load_le<std::uint8_t>(payload, 0);
  header.length = load_le<std::uint16_t>(payload, 1);
  header.time_interval_100ns = load_le<std::uint16_t>(payload, 3);
  header.points = load_le<std::uint16_t>(payload, 5);
  header.number = load_le<std::uint16_t>(payload, 7);
  header.frame = load_le<std::uint8_t>(payload, 9);
  header.data_type = load_le<std::uint8_t>(payload, 10);
  header.time_type = load_le<std::uint8_t>(payload, 11);
  header.checksum = load_le<std::uint32_t>(payload, 24);
  header.timestamp_ns = load_le<std::uint64_t>(payload, 28);
  return header;
}

void seal_sdk2_packet(const Sdk2Header& header, std::span<std::byte> packet) {
  std::fill_n(packet.begin(), Sdk2Header::kBytes, std::byte{0});
  store_le(packet, 0, header.version);
  store_le(packet, 1, static_cast<std::uint16_t>(packet.size()));
  store_le(packet, 3, header.time_interval_100ns);
  store_le(packet, 5, header.points);
  store_le(packet, 7, header.number);
  store_le(packet, 9, header.frame);
  store_le(packet, 10, header.data_type);
  store_le(packet, 11, header.time_type);
  store_le(packet, 28, header.timestamp_ns);
  store_le(packet, 24, sdk2_checksum(packet));
}

std::uint32_t sdk2_checksum(std::span<const std::byte> packet) {
  return crc32(packet.subspan(Sdk2Header::kChecked));
}

std::optional<Sdk2TimeType> sdk2_time_type_of(std::uint8_t raw) {
  return raw <= 2 ? std::optional(static_cast<Sdk2TimeType>(raw)) : std::nullopt;
}

}  // namespace slamd::livox
