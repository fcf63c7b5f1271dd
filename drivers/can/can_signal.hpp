#pragma once

#include <cstdint>
#include <optional>

#include "drivers/transport/can_frame.hpp"

namespace slamd::can {

using transport::CanFrame;

/// A number in the frames of one id: what a DBC file says of it in a line, with its numbering of bits.
struct CanSignal {
  std::uint32_t id = 0;
  bool is_extended = false;
  bool is_big_endian = false;  // Motorola: first_bit is the highest one, counted as 8 · byte + bit; else the lowest
  int first_bit = 0;
  int bits = 16;
  bool is_signed = false;
  double scale = 1.0;
  double offset = 0.0;

  /// Tells whether all of its bits lie in a frame of eight bytes, and its scale makes a difference.
  bool is_valid() const;
};

/// Reads a signal; nothing when the frame has another id or is too short for it.
/// Errors: programmer error unless the signal is valid.
std::optional<double> value_of(const CanSignal& signal, const CanFrame& frame);

/// Writes a signal's bits into a frame of its id, and leaves the others: the nearest number that the bits can hold.
/// Errors: programmer error unless the signal is valid and lies within the frame's size.
void put_value(const CanSignal& signal, double value, CanFrame& frame);

}  // namespace slamd::can
