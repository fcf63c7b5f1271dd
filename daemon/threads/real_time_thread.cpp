#include "daemon/threads/real_time_thread.hpp"

#include <cstddef>
#include <system_error>
#include <utility>

#include <sched.h>

namespace slamd::threads {

namespace {

/// Touches the stack that is to be used, so that no page fault comes later.
[[maybe_unused]] __attribute__((noinline)) void prefault_stack() {
  constexpr std::size_t kBytes = RealTimeThread::kStackBytes * 3 / 4;  // the rest: what glibc and the caller have used
  constexpr std::size_t kPage = 4096;
  [[maybe_unused]] volatile std::byte stack[kBytes];
  for (std::size_t i = 0; i < kBytes; i += kPage) {
    stack[i] = std::byte{0};
  }
}

}  // namespace

RealTimeThread::RealTimeThread(const std::string& name, Scheduling scheduling, std::function<void()> body)
    : body_(std::move(body)) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  const int failed = pthread_create(&thread_, &attributes, &RealTimeThread::run, this);
  pthread_attr_destroy(&attributes);
  if (failed != 0) {
    throw std::system_error(failed, std::generic_category(), "thread " + name);
  }
  pthread_setname_np(thread_, name.substr(0, 15).c_str());
  if (scheduling.fifo) {
    sched_param parameters{};
    parameters.sched_priority = scheduling.priority;
    fifo_ = pthread_setschedparam(thread_, SCHED_FIFO, &parameters) == 0;
  }
}

RealTimeThread::~RealTimeThread() { pthread_join(thread_, nullptr); }

void* RealTimeThread::run(void* self) {
#if !SLAMD_SANITIZED
  prefault_stack();
#endif
  static_cast<RealTimeThread*>(self)->body_();
  return nullptr;
}

}  // namespace slamd::threads
