// Any bytes into the SDK2 decoder, with and without a good checksum, and what it gives into the ScanAssembler.
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "core/sensor/scan_assembler.hpp"
#include "drivers/livox/sdk2_decoder.hpp"

namespace {

using slamd::Stamp;
using slamd::livox::DecodeResult;
using slamd::livox::Sdk2Header;

// The input as a packet that tells its own length and checksum.
std::vector<std::byte> sealed(std::span<const std::byte> input) {
  std::vector<std::byte> packet(input.begin(), input.end());
  Sdk2Header header = slamd::livox::parse_sdk2_header(packet);
  header.version = Sdk2Header::kVersion;
  seal_sdk2_packet(header, packet);
  return packet;
}

// The input as the body of a packet of the type and size that it asks for itself, all header fields consistent.
std::vector<std::byte> plausible_packet(std::span<const std::byte> input) {
  constexpr std::uint8_t kTypes[] = {0, 1, 2, 3, 0x11};
  constexpr std::size_t kBytes[] = {24, 14, 8, 10, 28};
  const std::size_t type = std::to_integer<std::size_t>(input[0]) % 5;
  Sdk2Header header;
  header.data_type = kTypes[type];
  header.points = static_cast<std::uint16_t>(type == 0 ? 1 : 1 + std::to_integer<unsigned>(input[1]) % 96);
  header.time_interval_100ns = slamd::load_le<std::uint16_t>(input, 2);
  header.timestamp_ns = slamd::load_le<std::uint64_t>(input, 4);
  const auto body = input.subspan(12);
  std::vector<std::byte> packet(Sdk2Header::kBytes + header.points * kBytes[type]);
  for (std::size_t i = 0; i < body.size() && Sdk2Header::kBytes + i < packet.size(); ++i) {
    packet[Sdk2Header::kBytes + i] = body[i];
  }
  seal_sdk2_packet(header, packet);
  return packet;
}

void check(const slamd::sensor::PointBlock& block) {
  for (const slamd::sensor::Point& point : block.points) {
    SLAMD_ASSERT(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m));
    SLAMD_ASSERT(point.line < 4 && point.echo < 2);
    SLAMD_ASSERT(slamd::Duration{point.offset_ns} < block.duration);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  slamd::livox::Sdk2Decoder decoder({});
  slamd::sensor::ScanAssembler assembler({.rule = slamd::sensor::CutRule::kPeriod,
                                          .period = std::chrono::microseconds{300},
                                          .max_points = 500});
  slamd::sensor::PointBlock block;
  slamd::livox::ImuReading imu;
  const auto feed = [&](std::span<const std::byte> packet, Stamp received) {
    const DecodeResult result = decoder.decode(packet, received, block, imu);
    if (result == DecodeResult::kPoints) {
      check(block);
      block.stamp = received;
      assembler.add(block);
    } else if (result == DecodeResult::kImu) {
      SLAMD_ASSERT(imu.angular_rate_radps.allFinite() && imu.specific_force_mps2.allFinite());
    }
  };
  feed(input, Stamp{});
  if (input.size() >= Sdk2Header::kBytes) {
    feed(sealed(input), Stamp{std::chrono::microseconds{480}});
  }
  if (input.size() >= 12) {
    feed(plausible_packet(input), Stamp{std::chrono::microseconds{960}});
  }
  assembler.flush();
  return 0;
}
