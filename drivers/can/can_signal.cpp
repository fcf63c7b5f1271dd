#include "drivers/can/can_signal.hpp"

#include "core/base/assert.hpp"

namespace slamd::can {

namespace {

constexpr int kFrameBits = 64;

/// Where the highest bit of a big-endian signal lies when bits are counted as they are sent, the highest of each byte first.
int sent_place(int bit) { return bit / 8 * 8 + 7 - bit % 8; }

}  // namespace

bool CanSignal::is_valid() const {
  if (bits < 1 || bits > kFrameBits || first_bit < 0 || first_bit >= kFrameBits) {
    return false;
  }
  return (is_big_endian ? sent_place(first_bit) : first_bit) + bits <= kFrameBits;
}

std::optional<double> value_of(const CanSignal& signal, const CanFrame& frame) {
  SLAMD_ASSERT(signal.is_valid());
  if (frame.id != signal.id || frame.is_extended != signal.is_extended) {
    return std::nullopt;
  }
  const int begin = signal.is_big_endian ? sent_place(signal.first_bit) : signal.first_bit;
  if (begin + signal.bits > 8 * frame.size) {
    return std::nullopt;
  }
  std::uint64_t raw = 0;
  for (int i = 0; i < signal.bits; ++i) {
    const int place = begin + i;
    const auto byte = std::to_integer<std::uint64_t>(frame.data[static_cast<std::size_t>(place / 8)]);
    if (signal.is_big_endian) {
      raw = raw << 1 | (byte >> (7 - place % 8) & 1U);
    } else {
      raw |= (byte >> place % 8 & 1U) << i;
    }
  }
  if (signal.is_signed) {
    const int unused = kFrameBits - signal.bits;
    return static_cast<double>(static_cast<std::int64_t>(raw << unused) >> unused) * signal.scale + signal.offset;
  }
  return static_cast<double>(raw) * signal.scale + signal.offset;
}

}  // namespace slamd::can
