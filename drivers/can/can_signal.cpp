#include "drivers/can/can_signal.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"

namespace slamd::can {

namespace {

constexpr int kFrameBits = 64;

/// Where the highest bit of a big-endian signal lies when bits are counted as they are sent, the highest of each byte first.
int sent_place(int bit) { return bit / 8 * 8 + 7 - bit % 8; }

/// Where the signal begins, in the order in which its bits are counted.
int begin_of(const CanSignal& signal) { return signal.is_big_endian ? sent_place(signal.first_bit) : signal.first_bit; }

}  // namespace

bool CanSignal::is_valid() const {
  if (bits < 1 || bits > kFrameBits || first_bit < 0 || first_bit >= kFrameBits) {
    return false;
  }
  return begin_of(*this) + bits <= kFrameBits && scale != 0.0;
}

std::optional<double> value_of(const CanSignal& signal, const CanFrame& frame) {
  SLAMD_ASSERT(signal.is_valid());
  if (frame.id != signal.id || frame.is_extended != signal.is_extended) {
    return std::nullopt;
  }
  const int begin = begin_of(signal);
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

void put_value(const CanSignal& signal, double value, CanFrame& frame) {
  SLAMD_ASSERT(signal.is_valid());
  const int begin = begin_of(signal);
  SLAMD_ASSERT(begin + signal.bits <= 8 * frame.size);
  const double range = std::ldexp(1.0, signal.is_signed ? signal.bits - 1 : signal.bits);
  const double lowest = signal.is_signed ? -range : 0.0;
  const double highest = std::min(range - 1.0, std::nextafter(range, 0.0));  // of 64 bits, a double does not know the last
  const double number = std::clamp(std::round((value - signal.offset) / signal.scale), lowest, highest);
  const auto raw = number < 0.0 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(number)) : static_cast<std::uint64_t>(number);
  for (int i = 0; i < signal.bits; ++i) {
    const int place = begin + i;
    const int from = signal.is_big_endian ? signal.bits - 1 - i : i;
    const int to = signal.is_big_endian ? 7 - place % 8 : place % 8;
    std::byte& byte = frame.data[static_cast<std::size_t>(place / 8)];
    byte = (byte & ~(std::byte{1} << to)) | static_cast<std::byte>(raw >> from & 1U) << to;
  }
}

}  // namespace slamd::can
