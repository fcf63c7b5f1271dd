#include "tools/simulate/live_can.hpp"

#include <algorithm>

namespace slamd::simulate {

void LiveCan::add(const sensor::ImuSample& sample) {
  for (const transport::CanFrame& frame : imu_.frames_of(sample)) {
    insert(frame);
  }
}

void LiveCan::insert(const transport::CanFrame& frame) {
  const auto after = std::upper_bound(waiting_.begin(), waiting_.end(), frame.received,
                                      [](Stamp stamp, const transport::CanFrame& other) { return stamp < other.received; });
  waiting_.insert(after, frame);
}

void LiveCan::send_until(Stamp until, replay::NetworkPlayer& player) {
  for (; !waiting_.empty() && waiting_.front().received <= until && player.wait_until(waiting_.front().received); waiting_.pop_front()) {
    sender_.send(waiting_.front(), clock_);
    ++sent_;
  }
}

}  // namespace slamd::simulate
