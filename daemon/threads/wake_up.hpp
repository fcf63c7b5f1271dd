#pragma once

#include "core/base/stamp.hpp"

namespace slamd::threads {

/// Wakes one sleeping thread from any other.
/// Threads: notify() by any, wait() by one. Real-time: notify() never blocks; no allocation.
class WakeUp {
 public:
  WakeUp();
  ~WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  void notify();

  /// Sleeps until notified since the last wait, or for `longest`.
  void wait(Duration longest);

  /// For epoll; read() it empty by clear().
  int fd() const { return fd_; }
  void clear();

 private:
  int fd_;
};

}  // namespace slamd::threads
