#include "core/sensor/clock_model.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"

namespace slamd::sensor {

namespace {

constexpr double kAcquisition_ns = 1e9;  // at least, and until the mapping is as close as this:
constexpr double kAcquired_ns = 100e3;
constexpr double kAcquisitionStep_ns = 100e6;  // the first packets may be this late without a step
constexpr double kStep_ns = std::chrono::duration<double, std::nano>(ClockModel::kStep).count();
constexpr double kFarAbove_ns = 500e6;
constexpr Duration kOutage =
    std::chrono::milliseconds{12'800};  // the window holds nothing any more
constexpr double kAgreement_ns = 100e6;
constexpr Duration kSpanAfterGoingBack = std::chrono::milliseconds{50};
constexpr Duration kSpanFarAbove = std::chrono::seconds{1};

// A device may send any 64 bits: sums and differences wrap instead of overflowing.
std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

std::int64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

std::int64_t nanoseconds(Stamp stamp) {
  return stamp.time_since_epoch().count();
}

// The value that equals rest modulo period and is nearest to target.
std::int64_t nearest_congruent(std::int64_t rest, std::int64_t period, std::int64_t target) {
  std::int64_t distance = difference(rest, target) % period;  // in (-period, period)
  if (2 * distance >= period) {
    distance -= period;
  } else if (2 * distance < -period) {
    distance += period;
  }
  return sum(target, distance);
}

}  // namespace

ClockModel::ClockModel(const ClockConfig& config) : config_(config) {
  set_roll_over(config.roll_over);
}

void ClockModel::set_roll_over(Duration roll_over) {
  SLAMD_ASSERT(roll_over >= Duration::zero() && roll_over <= std::chrono::hours{24 * 365});
  config_.roll_over = roll_over;
}

Stamp ClockModel::map(DeviceStamp device, Stamp arrival) {
  ++health_.stamps;
  const std::int64_t raw_ns = device.time_since_epoch().count();
  const std::int64_t device_ns = unrolled_ns(raw_ns, arrival);
  std::int64_t mapped_ns = nanoseconds(arrival);
  if (anchored_) {
    const std::int64_t before_ns = newest_device_ns_;
    mapped_ns = sum(device_ns, offset_ns(device_ns, arrival));
    const bool became_newest = newest_device_ns_ == device_ns;
    health_.roll_overs += became_newest && device_ns > before_ns && raw_ns < newest_raw_ns_ ? 1 : 0;
    newest_raw_ns_ = became_newest ? raw_ns : newest_raw_ns_;
  } else {
    anchor(device_ns, arrival, 0.0, 0.0);
    newest_raw_ns_ = raw_ns;
  }
  if (config_.kind == ClockKind::kShared) {
    mapped_ns = difference(device_ns, health_.taken_off.count());
  }
  count_residual(difference(nanoseconds(arrival), mapped_ns));
  return Stamp{Duration{mapped_ns}};
}

void ClockModel::clear_residual() {
  residual_sum_ns_ = 0.0;
  residuals_ = 0;
  health_.residual_mean = Duration::zero();
  health_.residual_max = Duration::zero();
}

std::int64_t ClockModel::unrolled_ns(std::int64_t raw_ns, Stamp arrival) const {
  if (config_.roll_over == Duration::zero()) {
    return raw_ns;
  }
  if (config_.kind == ClockKind::kShared) {
    return nearest_congruent(raw_ns, config_.roll_over.count(), nanoseconds(arrival));
  }
  if (!anchored_) {
    return raw_ns;
  }
  const Duration elapsed = arrival - newest_arrival_;
  return nearest_congruent(
      raw_ns, config_.roll_over.count(), sum(newest_device_ns_, elapsed.count()));
}

void ClockModel::anchor(std::int64_t device_ns,
                        Stamp arrival,
                        double envelope_y_ns,
                        double applied_y_ns) {
  anchored_ = true;
  anchor_device_ns_ = device_ns;
  anchor_offset_ns_ = difference(nanoseconds(arrival), device_ns);
  newest_device_ns_ = device_ns;
  newest_arrival_ = arrival;
  newest_x_ns_ = 0.0;
  envelope_.restart({0.0, envelope_y_ns});
  applied_y_ns_ = applied_y_ns;
  acquiring_ = true;
  borne_out_ = 0;
  candidate_ = {};
}

std::int64_t ClockModel::offset_ns(std::int64_t device_ns, Stamp arrival) {
  Sample sample;
  sample.x_ns = static_cast<double>(difference(device_ns, anchor_device_ns_));
  sample.y_ns = static_cast<double>(
      difference(difference(nanoseconds(arrival), device_ns), anchor_offset_ns_));
  const double above_ns = sample.y_ns - envelope_.at(sample.x_ns);
  const bool newer = device_ns > newest_device_ns_;
  if (arrival - newest_arrival_ > kOutage) {
    begin_anew(sample, device_ns, arrival);
    return anchor_offset_ns_;
  }
  health_.out_of_order += newer ? 0 : 1;

  if (above_ns < (acquiring_ ? -kAcquisitionStep_ns : -kStep_ns)) {
    return offset_forward_ns(sample, device_ns, arrival);
  }
  if (device_ns == newest_device_ns_) {
    return applied_offset_ns(sample.x_ns);
  }
  if (candidate_.count > 0 && agrees(sample, false)) {
    if (confirms_backward_step(sample, device_ns, arrival)) {
      follow_step(sample, device_ns, arrival);
      return applied_offset_ns(newest_x_ns_);
    }
  } else if (!newer || above_ns > kFarAbove_ns) {
    begin_candidate(sample, device_ns, arrival, false);
    candidate_.went_back = !newer;
  } else {
    drop_candidate();
  }
  if (newer) {
    advance(sample, device_ns, arrival);
  }
  return applied_offset_ns(sample.x_ns);
}

// The sample would have arrived before it was sent: its clock stepped, or its stamp is a stray.
std::int64_t ClockModel::offset_forward_ns(const Sample& sample,
                                           std::int64_t device_ns,
                                           Stamp arrival) {
  if (candidate_.count == 0 || !agrees(sample, true)) {
    begin_candidate(sample, device_ns, arrival, true);
  } else if (device_ns > candidate_.newest_ns) {
    candidate_.least_y_ns = std::min(candidate_.least_y_ns, sample.y_ns);
    follow_step(sample, device_ns, arrival);
    return applied_offset_ns(newest_x_ns_);
  }
  return sum(anchor_offset_ns_, std::llround(candidate_.first_y_ns));
}

// Whether a sample continues the candidate: much nearer to it than to the envelope.
bool ClockModel::agrees(const Sample& sample, bool forward) const {
  const double distance_ns = std::abs(candidate_.first_y_ns - envelope_.at(sample.x_ns));
  return candidate_.forward == forward &&
         std::abs(sample.y_ns - candidate_.first_y_ns) < std::min(0.5 * distance_ns, kAgreement_ns);
}

bool ClockModel::confirms_backward_step(const Sample& sample,
                                        std::int64_t device_ns,
                                        Stamp arrival) {
  if (device_ns <= candidate_.newest_ns) {
    return false;
  }
  ++candidate_.count;
  candidate_.newest_ns = device_ns;
  candidate_.least_y_ns = std::min(candidate_.least_y_ns, sample.y_ns);
  const Duration span = candidate_.went_back ? kSpanAfterGoingBack : kSpanFarAbove;
  return candidate_.count >= kBackwardConfirmations && arrival - candidate_.first_arrival >= span &&
         candidate_.least_y_ns - envelope_.at(sample.x_ns) >= kStep_ns;
}

void ClockModel::begin_candidate(const Sample& sample,
                                 std::int64_t device_ns,
                                 Stamp arrival,
                                 bool forward) {
  drop_candidate();
  candidate_.count = 1;
  candidate_.forward = forward;
  candidate_.newest_ns = device_ns;
  candidate_.first_arrival = arrival;
  candidate_.first_y_ns = sample.y_ns;
  candidate_.least_y_ns = sample.y_ns;
}

void ClockModel::drop_candidate() {
  if (candidate_.count > 0 && candidate_.forward) {
    ++health_.strays;
  }
  candidate_ = {};
}

void ClockModel::follow_step(const Sample& sample, std::int64_t device_ns, Stamp arrival) {
  count_step(envelope_at(arrival) - candidate_.least_y_ns);
  // Forward, the candidate is what packets are mapped by already.
  const double applied_y_ns = candidate_.forward ? candidate_.first_y_ns : candidate_.least_y_ns;
  note_shared_delay(arrival);
  anchor(device_ns, arrival, candidate_.least_y_ns - sample.y_ns, applied_y_ns - sample.y_ns);
  take_off_step();
}

// After an outage the first arrival counts again: the extrapolated envelope may be off by the drift
// meanwhile.
void ClockModel::begin_anew(const Sample& sample, std::int64_t device_ns, Stamp arrival) {
  const double step_ns = envelope_at(arrival) - sample.y_ns;
  if (std::abs(step_ns) > kFarAbove_ns) {
    count_step(step_ns);
  }
  note_shared_delay(arrival);
  anchor(device_ns, arrival, 0.0, 0.0);
  take_off_step();
}

// Samples that nothing bore out, as a first one that is wild, say nothing of where the shared clock was.
void ClockModel::note_shared_delay(Stamp arrival) {
  if (borne_out_ >= kBackwardConfirmations) {
    shared_delay_ns_ = sum(anchor_offset_ns_, std::llround(envelope_at(arrival)));
    shared_taken_off_ns_ = health_.taken_off.count();
  }
}

void ClockModel::take_off_step() {
  if (config_.kind != ClockKind::kShared || !shared_delay_ns_) {
    return;
  }
  const auto is_step = [](std::int64_t ns) { return ns > Duration{kSharedStep}.count() || ns < -Duration{kSharedStep}.count(); };
  const std::int64_t delay_ns = sum(anchor_offset_ns_, std::llround(envelope_.at(0.0)));
  if (!is_step(delay_ns)) {  // arrivals say that it is the shared clock: again, or at last, as when a device locks to it
    health_.taken_off = Duration{};
    return;
  }
  const std::int64_t step_ns = difference(*shared_delay_ns_, delay_ns);
  const std::int64_t taken_off_ns = is_step(step_ns) ? sum(shared_taken_off_ns_, step_ns) : shared_taken_off_ns_;
  health_.taken_off = Duration{is_step(taken_off_ns) ? taken_off_ns : 0};
}

// The envelope at the device time that would belong to an arrival, had the device's clock not
// stepped.
double ClockModel::envelope_at(Stamp arrival) const {
  return envelope_.at(newest_x_ns_ + static_cast<double>((arrival - newest_arrival_).count()));
}

void ClockModel::count_step(double step_ns) {
  ++health_.steps;
  health_.last_step = Duration{std::llround(step_ns)};
}

void ClockModel::advance(const Sample& sample, std::int64_t device_ns, Stamp arrival) {
  const double dt_ns = std::max(0.0, sample.x_ns - newest_x_ns_);  // differences of any 64 bits saturate
  newest_x_ns_ = sample.x_ns;
  newest_device_ns_ = device_ns;
  newest_arrival_ = arrival;
  borne_out_ += borne_out_ < kBackwardConfirmations ? 1 : 0;
  applied_y_ns_ += health_.skew * dt_ns;

  envelope_.add(sample);
  health_.skew = envelope_.slope();
  const double error_ns = envelope_.at(sample.x_ns) - applied_y_ns_;
  if (!acquiring_ && error_ns > kStep_ns) {
    // The whole window lies above: the clock fell back, or latency rose, for good.
    count_step(-error_ns);
    applied_y_ns_ += error_ns;
    return;
  }
  const double limit_ns = (acquiring_ ? kAcquisitionSlew : kSlew) * dt_ns;
  applied_y_ns_ += std::clamp(error_ns, -limit_ns, limit_ns);
  if (sample.x_ns >= kAcquisition_ns &&
      std::abs(envelope_.at(sample.x_ns) - applied_y_ns_) < kAcquired_ns) {
    acquiring_ = false;
  }
}

std::int64_t ClockModel::applied_offset_ns(double x_ns) const {
  return sum(anchor_offset_ns_, std::llround(applied_y_ns_ + health_.skew * (x_ns - newest_x_ns_)));
}

void ClockModel::count_residual(std::int64_t residual_ns) {
  residual_sum_ns_ += static_cast<double>(residual_ns);
  ++residuals_;
  health_.residual_mean =
      Duration{std::llround(residual_sum_ns_ / static_cast<double>(residuals_))};
  health_.residual_max = std::max(health_.residual_max, Duration{residual_ns});
}

}  // namespace slamd::sensor
