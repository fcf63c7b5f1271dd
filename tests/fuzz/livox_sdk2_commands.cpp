// Any bytes as SDK2 control frames, with and without good checksums, into the codec and the host.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/assert.hpp"
#include "drivers/livox/sdk2_host.hpp"

namespace {

using slamd::Stamp;
using namespace slamd::livox;

constexpr Endpoint kDevice{0xC0A80170, 56100};

// What is read must be written as the same bytes again, but for reserved ones.
void check_codec(std::span<const std::byte> bytes) {
  Sdk2Frame frame;
  std::size_t size = 0;
  if (parse_sdk2_frame(bytes, frame, size) != FrameResult::kOk || frame.payload.size() > 200) {
    return;
  }
  const FrameBytes again = write_sdk2_frame(frame);
  SLAMD_ASSERT(again.size() == size);
  SLAMD_ASSERT(std::equal(again.begin(), again.begin() + 12, bytes.begin()));
  SLAMD_ASSERT(std::equal(again.begin() + 20, again.end(), bytes.begin() + 20));
}

}  // namespace

// The input is a script: kind and command, number, length, payload; or a step of time.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  check_codec(input);
  Sdk2HostConfig config;
  config.interfaces.push_back({0xC0A80105, 0xFFFFFF00});
  config.take_over = size % 2 == 0;
  Sdk2Host host(config);
  HostOutput out;
  Stamp now{std::chrono::seconds{1000}};
  host.receive(input, kDevice, now, out);
  constexpr Sdk2Command kCommands[] = {Sdk2Command::kDiscovery, Sdk2Command::kSetParameters, Sdk2Command::kGetParameters,
                                       Sdk2Command::kStatePush, Sdk2Command::kGpsTime};
  for (std::size_t at = 0; at + 3 <= input.size();) {
    const auto field = [&](std::size_t i) { return std::to_integer<unsigned>(input[at + i]); };
    const unsigned what = field(0) % 16;
    if (what >= 10) {
      now += std::chrono::milliseconds{50 * field(1)};
      out.clear();
      host.advance(now, out);
      at += 2;
      continue;
    }
    const std::size_t length = std::min<std::size_t>(field(2) % 120, input.size() - at - 3);
    const FrameBytes datagram = write_sdk2_frame({field(1), kCommands[what % 5], what < 5, true, input.subspan(at + 3, length)});
    check_codec(datagram.view());
    out.clear();
    host.receive(datagram.view(), kDevice, now, out);
    for (const HostEvent& event : out.events) {
      SLAMD_ASSERT(!words_for(event).empty());
    }
    at += 3 + length;
  }
  return 0;
}
