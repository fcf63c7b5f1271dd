// Any bytes as streams of an Xsens and of a MicroStrain, in pieces; as what they say while they are set up; and as the
// contents of good frames.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "drivers/imu/line_setup.hpp"
#include "drivers/imu/mip.hpp"
#include "drivers/imu/xsens.hpp"

namespace {

using namespace slamd::imu;

void check(const slamd::sensor::ImuReading& reading) {
  SLAMD_ASSERT(reading.angular_rate_radps.allFinite() && reading.specific_force_mps2.allFinite());
}

// Every byte of a stream is in a frame, skipped, or in hand; the same bytes give the same in any pieces.
template <typename Reader>
void check_stream(std::span<const std::byte> input) {
  Reader whole;
  Reader pieces;
  std::uint64_t samples = 0;
  const auto visit = [&](const slamd::sensor::ImuReading& reading) {
    check(reading);
    ++samples;
  };
  whole.add(input, slamd::Stamp{}, visit);
  const std::uint64_t at_once = samples;
  for (std::span<const std::byte> rest = input; !rest.empty();) {
    const std::size_t piece = std::min<std::size_t>(rest.size(), 1 + std::to_integer<unsigned>(rest[0]) % 64);
    pieces.add(rest.first(piece), slamd::Stamp{}, visit);
    rest = rest.subspan(piece);
  }
  SLAMD_ASSERT(samples == 2 * at_once && pieces.pending() == whole.pending());
  const StreamCounters counters = whole.stream();
  SLAMD_ASSERT(counters.frame_bytes + counters.skipped_bytes + whole.pending() == input.size());
  SLAMD_ASSERT(whole.counters().of(InertialResult::kSample) == at_once);
}

// Whatever a line says while it is set up: all of it is taken until it is ready, and none afterwards.
void check_setup(Protocol protocol, std::span<const std::byte> input) {
  LineSetup setup({protocol, 0, protocol == Protocol::kCsv ? 0 : 400});
  LineOutput out;
  slamd::Stamp now{};
  setup.begin(now, out);
  for (std::span<const std::byte> rest = input; !rest.empty();) {
    const std::size_t piece = std::min<std::size_t>(rest.size(), 1 + std::to_integer<unsigned>(rest[0]) % 64);
    const std::size_t taken = setup.receive(rest.first(piece), now, out);
    SLAMD_ASSERT(taken <= piece && (setup.is_ready() || taken == piece));
    setup.advance(now, out);
    out = {};
    now += std::chrono::milliseconds(10 * piece);
    rest = rest.subspan(piece);
  }
  if (setup.is_ready()) {
    SLAMD_ASSERT(setup.receive(input, now, out) == 0);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  check_stream<XsensReader>(input);
  check_stream<MipReader>(input);
  for (const Protocol protocol : {Protocol::kCsv, Protocol::kXsens, Protocol::kMip}) {
    check_setup(protocol, input);
  }
  if (input.empty()) {
    return 0;
  }
  const auto body = input.subspan(1).first(std::min<std::size_t>(input.size() - 1, 250));
  const XbusBytes xsens = write_xbus({xbus::kMtData2, body});
  check_stream<XsensReader>(xsens.view());
  const MipBytes mip = write_mip({static_cast<std::uint8_t>(input[0] == std::byte{0} ? 0x0C : 0x80), body});
  check_stream<MipReader>(mip.view());
  return 0;
}
