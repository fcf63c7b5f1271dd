#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/sensor/wheel_sample.hpp"
#include "drivers/can/can_signal.hpp"

namespace slamd::can {

/// How a vehicle's wheels tell how it moves.
enum class WheelModel : std::uint8_t {
  kDifferential,  // a left and a right speed
  kAckermann,     // a speed and the angle of the front wheels
};

/// Where the wheels' numbers are on the bus. Scale and offset make m/s of a speed and rad of an angle; forward and to
/// the left are positive.
struct WheelSignals {
  WheelModel model = WheelModel::kDifferential;
  std::array<CanSignal, 2> signals;  // left and right speed; or speed and steering angle
  double base_m = 0.5;               // between the left and the right wheels; or between the axles
};

/// What became of a frame, or of a number in it.
enum class WheelResult : std::uint8_t {
  kSample,
  kOther,       // of another id
  kIncomplete,  // one number without the other
  kMalformed,   // shorter than the signal's place
  kOutOfRange,  // faster than 100 m/s or 10 rad/s, or steered by a right angle and more
};

inline constexpr std::size_t kWheelResults = 5;

/// Names a result as reports and health spell it.
const char* name_of(WheelResult result);

/// Makes samples of wheel odometry of CAN frames.
///
/// A sample needs both numbers, in one frame or in two that come within kTogether; it is complete with the later one,
/// and stamped with its arrival. Of an Ackermann vehicle each speed makes a sample; the angle may come more seldom, and
/// holds for kHeld.
/// Frames: base, which lies on the rear axle of an Ackermann vehicle.  Units: m/s, rad/s.
/// Real-time: never allocates; O(bits); one thread.
class WheelReader {
 public:
  static constexpr Duration kTogether = std::chrono::milliseconds{10};
  static constexpr Duration kHeld = std::chrono::milliseconds{250};

  /// Errors: programmer error unless both signals are valid.
  explicit WheelReader(const WheelSignals& signals);

  /// Takes a frame. Returns true when it completes a good sample, which is then in `sample`.
  bool take(const CanFrame& frame, sensor::WheelSample& sample);

  /// Samples, frames (kOther, kMalformed) and single numbers (kIncomplete) by what became of them.
  const std::array<std::uint64_t, kWheelResults>& counts() const { return counts_; }
  std::uint64_t of(WheelResult result) const { return counts_[static_cast<std::size_t>(result)]; }

 private:
  struct Number {
    double value = 0.0;
    Stamp received{};
  };

  bool is_carried_by(const CanFrame& frame) const;
  bool note(std::size_t which, const CanFrame& frame);
  bool is_complete(Stamp now);
  void count(WheelResult result) { ++counts_[static_cast<std::size_t>(result)]; }

  WheelSignals signals_;
  std::array<std::optional<Number>, 2> numbers_;
  std::array<std::uint64_t, kWheelResults> counts_{};
};

}  // namespace slamd::can
