// Any bytes as SDK1 control frames, with and without good checksums, into the codec and the host.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "drivers/livox/sdk1_host.hpp"

namespace {

using slamd::Stamp;
using namespace slamd::livox;

constexpr Endpoint kDevice{0xC0A80170, 65000};

// What is read must be written as the same bytes again.
void check_codec(std::span<const std::byte> bytes) {
  Sdk1Frame frame;
  std::size_t size = 0;
  if (parse_sdk1_frame(bytes, frame, size) != FrameResult::kOk || frame.payload.size() > 200) {
    return;
  }
  const FrameBytes again = write_sdk1_frame(frame);
  SLAMD_ASSERT(std::equal(again.begin(), again.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
}

}  // namespace

// The input is a script: type, command, number, length, payload; or a step of time.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  check_codec(input);
  Sdk1HostConfig config;
  config.interfaces.push_back({0xC0A80132, 0xFFFFFF00});
  Sdk1Host host(config);
  HostOutput out;
  Stamp now{std::chrono::seconds{1000}};
  host.receive(input, kDevice, now, out);
  for (std::size_t at = 0; at + 4 <= input.size();) {
    const auto field = [&](std::size_t i) { return std::to_integer<unsigned>(input[at + i]); };
    const unsigned what = field(0);
    if (what % 4 == 3) {
      now += std::chrono::milliseconds{50 * field(1)};
      out.clear();
      host.advance(now, out);
      at += 2;
      continue;
    }
    const std::size_t length = std::min<std::size_t>(field(3) % 40, input.size() - at - 4);
    const Sdk1Frame frame{static_cast<Sdk1FrameType>(what % 4), static_cast<std::uint16_t>(field(2)),
                          static_cast<Sdk1Command>((what & 128U) != 0 ? 256U + field(1) % 16U : field(1) % 16U),
                          input.subspan(at + 4, length)};
    const FrameBytes datagram = write_sdk1_frame(frame);
    check_codec(datagram.view());
    out.clear();
    host.receive(datagram.view(), kDevice, now, out);
    for (const HostEvent& event : out.events) {
      SLAMD_ASSERT(!words_for(event).empty());
    }
    at += 4 + length;
  }
  return 0;
}
