#pragma once

#include <atomic>
#include <cstdint>

namespace slamd {

/// Counts events in one thread and shows the count to all others.
/// Threads: one writer calls add(); value() is for any thread and may lag, but never goes back for
/// a reader.
/// Real-time: wait-free, without a locked instruction.
class Counter {
 public:
  void add(std::uint64_t events = 1) {
    value_.store(value_.load(std::memory_order_relaxed) + events, std::memory_order_relaxed);
  }

  std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};  // written by the counting thread, read by health
};

}  // namespace slamd
