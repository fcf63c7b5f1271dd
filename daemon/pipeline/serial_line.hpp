#pragma once

#include <atomic>
#include <cstddef>
#include <span>
#include <string>

#include "core/base/fixed_vector.hpp"
#include "daemon/threads/wake_up.hpp"
#include "drivers/transport/serial_port.hpp"

namespace slamd::pipeline {

/// A serial port that two threads hand to each other: the serial thread opens, sets and closes it, all of which may
/// block; the receive thread reads samples from it, which does not.
/// Threads: port() and rest() belong to the one that has the port, the serial thread at first.
/// Real-time: allocates in the constructor only; take() and give_back() never block.
class SerialLine {
 public:
  explicit SerialLine(const std::string& device) : port_({.device = device}) {}

  transport::SerialPort& port() { return port_; }

  /// What was read and is not yet decoded when the port is handed on.
  std::span<const std::byte> rest() const { return rest_.view(); }

  /// Serial thread: gives the port to the receive thread, with bytes that it must decode first.
  void hand_on(std::span<const std::byte> rest) {
    rest_.clear();
    for (const std::byte byte : rest) {
      rest_.push_back(byte);
    }
    with_receive_.store(true, std::memory_order_release);
    handed_.notify();
  }

  /// Serial thread: sleeps while the receive thread has the port, at most for `longest`. Returns whether it is back.
  bool wait_for_return(Duration longest) {
    if (with_receive_.load(std::memory_order_acquire)) {
      returned_.wait(longest);
    }
    return !with_receive_.load(std::memory_order_acquire);
  }

  /// Receive thread: readable when the port is handed on.
  int handed_fd() const { return handed_.fd(); }

  /// Receive thread: tells whether it has the port.
  bool take() {
    handed_.clear();
    return with_receive_.load(std::memory_order_acquire);
  }

  /// Receive thread: gives the port back, for it is gone or silent.
  void give_back() {
    with_receive_.store(false, std::memory_order_release);
    returned_.notify();
  }

 private:
  transport::SerialPort port_;
  FixedVector<std::byte, transport::SerialPortConfig::kBufferBytes> rest_;
  std::atomic<bool> with_receive_{false};
  threads::WakeUp handed_;
  threads::WakeUp returned_;
};

}  // namespace slamd::pipeline
