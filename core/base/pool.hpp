#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/bounded_vector.hpp"
#include "core/base/counter.hpp"
#include "core/base/spsc_queue.hpp"

namespace slamd {

/// Lends out a fixed number of objects, all constructed with it. Objects keep their contents
/// between loans.
/// Threads: acquire() and put_back() by one thread, the acquirer; handles end in one thread, the
/// releaser (the same or another one); in between they may pass through any threads and queues.
/// low_water() and exhausted() by anyone.
/// Real-time: wait-free; allocates in the constructor only.
template <typename T>
class Pool {
 public:
  /// The right to use one object; ends with its destruction or reset(), in the releaser thread.
  class Handle {
   public:
    Handle() = default;

    Handle(Handle&& other) noexcept
        : pool_(std::exchange(other.pool_, nullptr)), index_(other.index_) {}

    Handle& operator=(Handle&& other) noexcept {
      if (this != &other) {
        reset();
        pool_ = std::exchange(other.pool_, nullptr);
        index_ = other.index_;
      }
      return *this;
    }

    ~Handle() { reset(); }

    explicit operator bool() const { return pool_ != nullptr; }

    T& operator*() const { return pool_->objects_[index_]; }

    T* operator->() const { return &pool_->objects_[index_]; }

    T* get() const { return pool_ == nullptr ? nullptr : &pool_->objects_[index_]; }

    /// Gives the object back; the handle is empty then.
    void reset() {
      if (pool_ != nullptr) {
        std::exchange(pool_, nullptr)->release(index_);
      }
    }

   private:
    friend class Pool;

    Handle(Pool* pool, std::uint32_t index) : pool_(pool), index_(index) {}

    Pool* pool_ = nullptr;
    std::uint32_t index_ = 0;
  };

  /// Constructs size objects from the same arguments.
  template <typename... Args>
  explicit Pool(std::size_t size, const Args&... args)
      : free_(size), returned_(size), low_water_(size) {
    for (std::size_t i = 0; i < size; ++i) {
      objects_.emplace_back(args...);
      free_.push_back(static_cast<std::uint32_t>(size - 1 - i));
    }
  }

  // Handles point to the pool, which must outlive them.
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  std::size_t size() const { return objects_.size(); }

  /// Lends an object; an empty handle, counted in exhausted(), when none is free. Acquirer thread.
  [[nodiscard]] Handle acquire() {
    while (const auto index = returned_.try_pop()) {
      free_.push_back(*index);
    }
    if (free_.empty()) {
      exhausted_.add();
      return {};
    }
    const std::uint32_t index = free_.back();
    free_.resize(free_.size() - 1);
    if (free_.size() < low_water_.load(std::memory_order_relaxed)) {
      low_water_.store(free_.size(), std::memory_order_relaxed);
    }
    return {this, index};
  }

  /// Takes back an object that never left the acquirer, which is not the releaser. Acquirer thread.
  void put_back(Handle handle) {
    SLAMD_ASSERT(handle.pool_ == this);
    handle.pool_ = nullptr;
    free_.push_back(handle.index_);
  }

  /// The fewest objects that have ever been free.
  std::size_t low_water() const { return low_water_.load(std::memory_order_relaxed); }

  /// How often acquire() found no free object.
  std::uint64_t exhausted() const { return exhausted_.value(); }

 private:
  void release(std::uint32_t index) {
    const bool room = returned_.try_push(index);
    SLAMD_ASSERT(room);  // as long as the pool: fails only when a handle was released twice
  }

  std::deque<T> objects_;
  BoundedVector<std::uint32_t> free_;   // the acquirer's own
  SpscQueue<std::uint32_t> returned_;   // from the releaser to the acquirer
  std::atomic<std::size_t> low_water_;  // written by the acquirer, read by health
  Counter exhausted_;                   // written by the acquirer, read by health
};

}  // namespace slamd
