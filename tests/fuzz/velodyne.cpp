// Any bytes into the Velodyne decoders, and what they give into the ScanAssembler.
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "core/sensor/scan_assembler.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "drivers/velodyne/position.hpp"

namespace {

using slamd::Stamp;
using slamd::velodyne::Decoder;

// A packet whose flags, azimuths and factory bytes are right; the fuzzer's bytes are laid over it.
std::vector<std::byte> plausible_packet() {
  std::vector<std::byte> packet(Decoder::kPacketBytes);
  for (std::size_t block = 0; block < 12; ++block) {
    const std::size_t at = 100 * block;
    const auto azimuth_cdeg = static_cast<std::uint16_t>(40 * block);
    packet[at] = std::byte{0xFF};
    packet[at + 1] = std::byte{0xEE};
    packet[at + 2] = static_cast<std::byte>(azimuth_cdeg & 0xFFU);
    packet[at + 3] = static_cast<std::byte>(azimuth_cdeg >> 8U);
  }
  packet[1204] = std::byte{0x37};
  packet[1205] = std::byte{0x22};
  return packet;
}

void check(const slamd::sensor::PointBlock& block) {
  for (const slamd::sensor::Point& point : block.points) {
    SLAMD_ASSERT(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m));
    SLAMD_ASSERT(point.line < 32);
  }
  for (const slamd::sensor::Sequence& sequence : block.sequences) {
    SLAMD_ASSERT(sequence.first_point <= block.points.size());
    SLAMD_ASSERT(sequence.azimuth_cdeg < 36000);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static Decoder decoder({});  // keeps nothing between packets but counters
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  slamd::velodyne::Position position;
  slamd::velodyne::decode_position(input, position);
  slamd::sensor::PointBlock block;
  decoder.decode(input, Stamp{}, block);
  if (input.size() < 3) {
    return 0;
  }
  // The first byte says how many packets come, the next two where the rest is laid over each of them.
  slamd::sensor::ScanAssembler assembler({.max_points = 1000});
  std::vector<std::byte> packet = plausible_packet();
  const std::size_t offset = std::to_integer<std::size_t>(input[1]) << 8U | std::to_integer<std::size_t>(input[2]);
  for (std::size_t i = 3; i < input.size(); ++i) {
    packet[(offset + i) % packet.size()] = input[i];
  }
  const std::size_t packets = 1 + std::to_integer<std::size_t>(input[0]) % 4;
  for (std::size_t i = 0; i < packets; ++i) {
    packet[1201] = static_cast<std::byte>(5 * i);  // 1.28 ms later
    if (decoder.decode(packet, Stamp{}, block) == slamd::velodyne::DecodeResult::kOk) {
      check(block);
      block.stamp = Stamp{block.device_stamp.time_since_epoch()};
      assembler.add(block);
    }
  }
  assembler.flush();
  return 0;
}
