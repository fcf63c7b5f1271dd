#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/assert.hpp"

namespace slamd {

/// Two indices of different threads never share a cache line of this size.
inline constexpr std::size_t kCacheLine_bytes = 64;

/// Hands values from one thread to one other, in order. When full, try_push refuses: the producer
/// drops and counts.
/// Threads: try_push by the producer, try_pop by the consumer only.
/// Real-time: wait-free; allocates in the constructor only (capacity + 1 values of T).
template <typename T>
class SpscQueue {
  static_assert(std::is_default_constructible_v<T> && std::is_nothrow_move_assignable_v<T>);

 public:
  explicit SpscQueue(std::size_t capacity) : slots_(capacity + 1) { SLAMD_ASSERT(capacity > 0); }

  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;

  std::size_t capacity() const { return slots_.size() - 1; }

  /// Appends a value unless the queue is full; returns whether it did (value is moved from only
  /// then).
  bool try_push(T&& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = after(tail);
    if (next == head_seen_) {
      head_seen_ = head_.load(std::memory_order_acquire);
      if (next == head_seen_) {
        return false;
      }
    }
    slots_[tail] = std::move(value);
    tail_.store(next, std::memory_order_release);
    return true;
  }

  bool try_push(const T& value) {
    T copy = value;
    return try_push(std::move(copy));
  }

  /// Takes the oldest value, if there is one.
  std::optional<T> try_pop() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_seen_) {
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head == tail_seen_) {
        return std::nullopt;
      }
    }
    std::optional<T> value(std::move(slots_[head]));
    head_.store(after(head), std::memory_order_release);
    return value;
  }

  /// How many values are queued. Exact when the other thread rests; otherwise the producer may see
  /// too many, the consumer too few, and a third thread anything in between.
  std::size_t size() const {
    const std::size_t head = head_.load(std::memory_order_acquire);
    const std::size_t tail = tail_.load(std::memory_order_acquire);
    return tail >= head ? tail - head : tail + slots_.size() - head;
  }

  bool empty() const { return size() == 0; }

 private:
  std::size_t after(std::size_t index) const { return index + 1 == slots_.size() ? 0 : index + 1; }

  // slots_[head_ .. tail_) belong to the consumer, all others to the producer.
  std::vector<T> slots_;

  // Written by the producer (release), read by the consumer (acquire).
  alignas(kCacheLine_bytes) std::atomic<std::size_t> tail_{0};
  // The producer's own: head_ as it last saw it. An old value only makes it look again.
  std::size_t head_seen_ = 0;

  // Written by the consumer (release), read by the producer (acquire).
  alignas(kCacheLine_bytes) std::atomic<std::size_t> head_{0};
  // The consumer's own: tail_ as it last saw it.
  std::size_t tail_seen_ = 0;
};

}  // namespace slamd
