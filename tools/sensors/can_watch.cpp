#include "tools/sensors/can_watch.hpp"

namespace slamd::sensors {

void CanWatch::take(const transport::CanFrame& frame) {
  frames_.add();
  const std::pair key(frame.is_extended, frame.id);
  if (ids_.size() < kMostIds || ids_.contains(key)) {
    Id& id = ids_[key];
    id.size = frame.size;
    id.frames.add();
  } else {
    ++left_out_;
  }
  sensor::ImuReading reading;
  if (xsens_.take(frame, reading)) {
    xsens_watch_.add(reading);
  }
  if (aceinna_.take(frame, reading)) {
    aceinna_watch_.add(reading);
  }
}

void CanWatch::end_second() {
  frames_.end_second();
  for (auto& [key, id] : ids_) {
    id.frames.end_second();
  }
  xsens_watch_.end_second();
  aceinna_watch_.end_second();
}

BusSeen CanWatch::seen() const {
  BusSeen seen;
  seen.frames = frames_.count();
  seen.ids_left_out = left_out_;
  for (const auto& [key, id] : ids_) {
    seen.ids.push_back({key.second, key.first, id.size, id.frames.count()});
  }
  seen.xsens = xsens_watch_.seen(xsens_.counters());
  seen.aceinna = aceinna_watch_.seen(aceinna_.counters());
  return seen;
}

}  // namespace slamd::sensors
