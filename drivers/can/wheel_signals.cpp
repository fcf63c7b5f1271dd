#include "drivers/can/wheel_signals.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"

namespace slamd::can {

namespace {

constexpr double kFastest_mps = 100.0;
constexpr double kFastest_radps = 10.0;

/// Of an Ackermann vehicle's signals.
constexpr std::size_t kSpeed = 0;
constexpr std::size_t kAngle = 1;

}  // namespace

const char* name_of(WheelResult result) {
  switch (result) {
    case WheelResult::kSample: return "sample";
    case WheelResult::kOther: return "other";
    case WheelResult::kIncomplete: return "incomplete";
    case WheelResult::kMalformed: return "malformed";
    case WheelResult::kOutOfRange: return "out_of_range";
  }
  return "?";
}

WheelReader::WheelReader(const WheelSignals& signals) : signals_(signals) {
  SLAMD_ASSERT(signals.signals[0].is_valid() && signals.signals[1].is_valid() && signals.base_m > 0.0);
}

bool WheelReader::take(const CanFrame& frame, sensor::WheelSample& sample) {
  if (!is_carried_by(frame)) {
    count(WheelResult::kOther);
    return false;
  }
  // Both numbers may be in one frame.
  const bool has_first = note(0, frame);
  const bool has_second = note(1, frame);
  const bool is_ackermann = signals_.model == WheelModel::kAckermann;
  if (!(has_first || (has_second && !is_ackermann)) || !is_complete(frame.received)) {
    return false;
  }
  const double first = numbers_[0]->value;
  const double second = numbers_[1]->value;
  sample.stamp = frame.received;
  if (is_ackermann) {
    sample.speed_mps = first;
    sample.turn_rate_radps = first * std::tan(second) / signals_.base_m;
    numbers_[kSpeed].reset();
  } else {
    sample.speed_mps = 0.5 * (first + second);
    sample.turn_rate_radps = (second - first) / signals_.base_m;
    numbers_ = {};
  }
  const bool is_steered_too_far = is_ackermann && std::abs(second) >= 0.5 * M_PI;
  const bool in_range = std::abs(sample.speed_mps) <= kFastest_mps && std::abs(sample.turn_rate_radps) <= kFastest_radps;
  const bool is_good = in_range && !is_steered_too_far;
  count(is_good ? WheelResult::kSample : WheelResult::kOutOfRange);
  return is_good;
}

bool WheelReader::is_carried_by(const CanFrame& frame) const {
  return std::any_of(signals_.signals.begin(), signals_.signals.end(), [&](const CanSignal& signal) {
    return signal.id == frame.id && signal.is_extended == frame.is_extended;
  });
}

/// Takes a number from a frame, if it is there.
bool WheelReader::note(std::size_t which, const CanFrame& frame) {
  const CanSignal& signal = signals_.signals[which];
  if (signal.id != frame.id || signal.is_extended != frame.is_extended) {
    return false;
  }
  const std::optional<double> value = value_of(signal, frame);
  if (!value) {
    count(WheelResult::kMalformed);
    return false;
  }
  const bool is_held = signals_.model == WheelModel::kAckermann && which == kAngle;
  if (numbers_[which] && !is_held) {
    count(WheelResult::kIncomplete);  // its counterpart has not come
  }
  numbers_[which] = Number{*value, frame.received};
  return true;
}

/// Tells whether both numbers are there, of about the same time; forgets what is too old.
bool WheelReader::is_complete(Stamp now) {
  const bool is_ackermann = signals_.model == WheelModel::kAckermann;
  bool complete = true;
  for (std::size_t which = 0; which < numbers_.size(); ++which) {
    const bool is_held = is_ackermann && which == kAngle;
    if (numbers_[which] && now - numbers_[which]->received > (is_held ? kHeld : kTogether)) {
      numbers_[which].reset();
      if (!is_held) {
        count(WheelResult::kIncomplete);
      }
    }
    complete = complete && numbers_[which].has_value();
  }
  return complete;
}

}  // namespace slamd::can
