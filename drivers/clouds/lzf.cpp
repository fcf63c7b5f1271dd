#include "drivers/clouds/lzf.hpp"

#include <algorithm>
#include <cstdint>

namespace slamd::clouds {

namespace {

/// Takes bytes off the front; `good` turns false at the first one that is missing.
struct Source {
  std::span<const std::byte> bytes;
  bool good = true;

  std::size_t take() {
    if (bytes.empty()) {
      good = false;
      return 0;
    }
    const auto value = std::to_integer<std::size_t>(bytes.front());
    bytes = bytes.subspan(1);
    return value;
  }
};

}  // namespace

bool lzf_unpack(std::span<const std::byte> packed, std::span<std::byte> out) {
  Source source{packed};
  std::size_t written = 0;
  while (!source.bytes.empty()) {
    const std::size_t control = source.take();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > source.bytes.size() || length > out.size() - written) {
        return false;
      }
      std::copy_n(source.bytes.begin(), length, out.begin() + static_cast<std::ptrdiff_t>(written));
      source.bytes = source.bytes.subspan(length);
      written += length;
      continue;
    }
    std::size_t length = control >> 5;
    length += length == 7 ? source.take() : 0;
    length += 2;
    const std::size_t distance = ((control & 31) << 8) + source.take() + 1;
    if (!source.good || distance > written || length > out.size() - written) {
      return false;
    }
    for (std::size_t i = 0; i < length; ++i, ++written) {  // byte by byte: the two may overlap
      out[written] = out[written - distance];
    }
  }
  return written == out.size();
}

}  // namespace slamd::clouds
