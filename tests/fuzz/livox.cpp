// Any bytes into the Livox decoder, and what it gives into the ScanAssembler.
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "core/sensor/scan_assembler.hpp"
#include "drivers/livox/livox_decoder.hpp"

namespace {

using slamd::Stamp;
using slamd::livox::DecodeResult;

// A packet of the data type `type` with a good header; the fuzzer's bytes follow, then zeros up to its length.
std::vector<std::byte> plausible_packet(std::span<const std::byte> input, std::uint8_t type) {
  constexpr std::size_t kBytes[] = {1318, 918, 1362, 978, 1362, 786, 42, 1278, 678};
  std::vector<std::byte> packet(kBytes[type]);
  packet[0] = std::byte{5};
  packet[8] = std::byte{1};
  packet[9] = std::byte{type};
  packet[12] = std::byte{1};
  for (std::size_t i = 0; i < input.size() && 18 + i < packet.size(); ++i) {
    packet[18 + i] = input[i];
  }
  return packet;
}

void check(const slamd::sensor::PointBlock& block) {
  for (const slamd::sensor::Point& point : block.points) {
    SLAMD_ASSERT(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m));
    SLAMD_ASSERT(point.line < 6 && point.echo < 3);
    SLAMD_ASSERT(point.offset_ns < 1'000'000);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  slamd::livox::LivoxDecoder decoder({});
  slamd::sensor::ScanAssembler assembler({.rule = slamd::sensor::CutRule::kPeriod,
                                          .period = std::chrono::microseconds{300},
                                          .max_points = 500});
  slamd::sensor::PointBlock block;
  slamd::livox::ImuReading imu;
  const auto feed = [&](std::span<const std::byte> packet, Stamp received) {
    if (decoder.decode(packet, received, block, imu) == DecodeResult::kPoints) {
      check(block);
      block.stamp = received;
      assembler.add(block);
    }
  };
  feed(input, Stamp{});
  if (!input.empty()) {
    const auto type = static_cast<std::uint8_t>(std::to_integer<unsigned>(input[0]) % 9);
    for (int i = 1; i <= 3; ++i) {
      feed(plausible_packet(input.subspan(1), type), Stamp{i * std::chrono::microseconds{400}});
    }
  }
  assembler.flush();
  return 0;
}
