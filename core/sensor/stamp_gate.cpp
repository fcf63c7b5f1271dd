#include "core/sensor/stamp_gate.hpp"

namespace slamd::sensor {

bool later_by_more(Stamp late, Stamp early, Duration duration) {
  std::int64_t difference_ns = 0;
  const bool overflows = __builtin_sub_overflow(late.time_since_epoch().count(), early.time_since_epoch().count(), &difference_ns);
  return late > early && (overflows || difference_ns > duration.count());
}

StampVerdict StampGate::judge(Stamp stamp) {
  if (newest_ && stamp <= *newest_) {
    return judge_old(stamp);
  }
  const bool leaps = newest_ ? later_by_more(stamp, *newest_, leap_) : !believes_first_;
  if (leaps && (!ahead_ || stamp <= *ahead_)) {
    ahead_ = stamp;
    return StampVerdict::kAhead;
  }
  newest_ = stamp;
  ahead_.reset();
  back_count_ = 0;
  return StampVerdict::kInOrder;
}

StampVerdict StampGate::judge_old(Stamp stamp) {
  if (back_count_ == 0 || stamp <= back_last_) {
    back_count_ = 0;
    back_first_ = stamp;
  }
  ++back_count_;
  back_last_ = stamp;
  if (back_count_ < kBackCount || !later_by_more(stamp, back_first_, kBackSpan)) {
    return StampVerdict::kOld;
  }
  newest_ = stamp;
  ahead_.reset();
  back_count_ = 0;
  return StampVerdict::kSteppedBack;
}

}  // namespace slamd::sensor
