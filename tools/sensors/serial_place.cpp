#include "tools/sensors/serial_place.hpp"

#include "drivers/transport/port_owner.hpp"

namespace slamd::sensors {

namespace {

/// Reads at once: more waits until the others have had their turn.
constexpr int kMostReads = 16;

}  // namespace

SerialPlace::SerialPlace(const std::string& device, bool asks, Stamp now)
    : device_(device), asks_(asks), port_({.device = device}), watch_(now) {
  open(now);
}

bool SerialPlace::is_held() {
  const std::string owner = transport::owner_of_terminal(device_);
  if (!owner.empty()) {
    trouble_ = "is held by " + owner + ", and left to it";
  }
  return !owner.empty();
}

void SerialPlace::open(Stamp now) {
  next_try_ = now + kRetry;
  if (is_held()) {
    return;
  }
  watch_.begin(now);
  port_.set_baud(watch_.baud());
  const int error = port_.open();
  const std::string words = error == 0 ? "" : port_.explain(error);
  const std::size_t name = words.find(device_ + ": ");
  trouble_ = name == std::string::npos ? words : words.substr(name + device_.size() + 2);
}

/// Whoever wants the line gets it: slamd may be started at any time.
bool SerialPlace::yield(Stamp now) {
  if (now < next_look_) {
    return false;
  }
  next_look_ = now + kRetry;
  if (!is_held()) {
    return false;
  }
  port_.close();
  next_try_ = now + kRetry;
  return true;
}

void SerialPlace::run_once(Stamp now) {
  if (!port_.is_open()) {
    if (now >= next_try_) {
      open(now);
    }
    return;
  }
  if (yield(now)) {
    return;
  }
  for (int i = 0; i < kMostReads; ++i) {
    const std::span<const std::byte> bytes = port_.read();
    if (bytes.empty()) {
      break;
    }
    watch_.take(bytes, now);
  }
  if (port_.is_gone()) {
    port_.close();
    trouble_ = "was unplugged";
    next_try_ = now + kRetry;
    return;
  }
  if (watch_.advance(now)) {
    port_.set_baud(watch_.baud());
  }
  if (asks_) {
    port_.write(watch_.take_question(now).view());
  }
}

LineSeen SerialPlace::seen() const {
  LineSeen seen = watch_.seen();
  seen.device = printable(device_);
  seen.trouble = trouble_;
  return seen;
}

}  // namespace slamd::sensors
