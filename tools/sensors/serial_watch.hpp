#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "core/base/stamp.hpp"
#include "drivers/transport/baud_hunt.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Finds out what speaks on a serial line, and at which rate: an inertial sensor (Xsens MTData2, MicroStrain MIP, CSV
/// rows) or a satellite receiver (NMEA, UBX). All are listened for at once, at one rate after the other, until one of
/// them has said two good frames; from then on that one is decoded.
/// Without port or clock: bytes and time go in, a rate goes out. Any bytes may be given.  Threads: one.
class SerialWatch {
 public:
  /// Longer than a receiver's pauses of a second.
  static constexpr Duration kDwell = std::chrono::milliseconds(1200);
  /// A line that has said nothing for so long has perhaps got another device, or another rate.
  static constexpr Duration kForgetAfter = std::chrono::seconds(5);

  explicit SerialWatch(Stamp now);
  ~SerialWatch();

  /// The port was opened (again).
  void begin(Stamp now);

  void take(std::span<const std::byte> bytes, Stamp now);

  /// Lets time pass. Returns whether the port must be set to another rate: what comes afterwards is at baud().
  bool advance(Stamp now);

  /// What to ask the device, when it is allowed to be asked and it is time to: something that sensors answer in any state,
  /// and that leaves them measuring. Empty: nothing.
  FixedVector<std::byte, 64> take_question(Stamp now);

  void end_second();

  int baud() const;

  /// Without device and trouble.
  LineSeen seen() const;

 private:
  struct Readers;

  void judge(Stamp now);
  bool answers_alone() const;
  void forget();

  transport::BaudHunt hunt_{kDwell};
  std::unique_ptr<Readers> readers_;
  Tongue tongue_ = Tongue::kNone;
  bool asked_ = false;  // at this rate
  Stamp heard_{};  // the last good frame
  SecondCount bytes_;
};

}  // namespace slamd::sensors
