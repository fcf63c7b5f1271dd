// Preloaded into slamd by slamd-bench pose-latency: every pose message grows to SLAMD_POSE_BYTES, so that the latency of
// a larger message is measured in the daemon itself, on its own way to the bus.
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <lcm/lcm.h>

namespace {

using Publish = int (*)(lcm_t*, const char*, const void*, unsigned int);

const auto publish = reinterpret_cast<Publish>(dlsym(RTLD_NEXT, "lcm_publish"));

unsigned int wanted_bytes() {
  const char* text = std::getenv("SLAMD_POSE_BYTES");
  return text == nullptr ? 0U : static_cast<unsigned int>(std::strtoul(text, nullptr, 10));
}

std::array<unsigned char, 1400> padded{};  // the publish thread's
const unsigned int padded_bytes = std::min<unsigned int>(wanted_bytes(), padded.size());

}  // namespace

extern "C" int lcm_publish(lcm_t* lcm, const char* channel, const void* data, unsigned int size) {
  if (!std::string_view(channel).ends_with("_POSE") || size >= padded_bytes) {
    return publish(lcm, channel, data, size);
  }
  std::memcpy(padded.data(), data, size);
  return publish(lcm, channel, padded.data(), padded_bytes);
}
