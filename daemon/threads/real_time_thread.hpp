#pragma once

#include <functional>
#include <string>

#include <pthread.h>

#include "core/base/sanitizer.hpp"

namespace slamd::threads {

/// How a thread is scheduled.
struct Scheduling {
  bool fifo = false;
  int priority = 0;  // of SCHED_FIFO, 1..99
};

/// A named thread with a small pre-faulted stack, joined by its destructor.
/// Errors: the constructor throws std::system_error when the thread cannot be made; where SCHED_FIFO is not permitted
/// it runs under SCHED_OTHER, and is_fifo() says so.
class RealTimeThread {
 public:
#if SLAMD_SANITIZED
  static constexpr std::size_t kStackBytes = 2048 * 1024;  // their frames are many times larger
#else
  static constexpr std::size_t kStackBytes = 256 * 1024;
#endif

  RealTimeThread(const std::string& name, Scheduling scheduling, std::function<void()> body);
  ~RealTimeThread();
  RealTimeThread(const RealTimeThread&) = delete;
  RealTimeThread& operator=(const RealTimeThread&) = delete;

  bool is_fifo() const { return fifo_; }

  /// Changes how it is scheduled. Who made the thread only.  Errors: false, and it runs as before, where that is not permitted.
  bool schedule(Scheduling scheduling);
  pthread_t handle() const { return thread_; }

 private:
  static void* run(void* self);

  std::function<void()> body_;
  pthread_t thread_{};
  bool fifo_ = false;
};

}  // namespace slamd::threads
