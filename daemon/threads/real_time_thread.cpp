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
    schedule(scheduling);
  }
}

RealTimeThread::~RealTimeThread() { pthread_join(thread_, nullptr); }

bool RealTimeThread::schedule(Scheduling scheduling) {
  sched_param parameters{};
  parameters.sched_priority = scheduling.fifo ? scheduling.priority : 0;
  const bool done = pthread_setschedparam(thread_, scheduling.fifo ? SCHED_FIFO : SCHED_OTHER, &parameters) == 0;
  fifo_ = done ? scheduling.fifo : fifo_;
  return done;
}

void* RealTimeThread::run(void* self) {
#if !SLAMD_SANITIZED
  prefault_stack();
#endif
  static_cast<RealTimeThread*>(self)->body_();
  return nullptr;
}

}  // namespace slamd::threads
