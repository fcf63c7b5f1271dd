#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <utility>

namespace slamd::client {

/// Shows what one thread makes to all others, whole, without either ever waiting: a few objects, of which the newest is
/// shown and those that somebody looks at are let be.
///
/// A reader counts itself in at the object that is shown, and looks whether it still is: if not, it counts itself out and
/// tries the next. The writer takes an object that is not shown and at which nobody is counted in; where all are being
/// looked at, it keeps what is shown and tries again later.
/// Threads: begin(), publish() by one writer; read() by any.
/// Real-time: read() is lock-free and repeats only when a publish() was completed meanwhile; begin() and publish() are wait-free.
template <typename T>
class ViewExchange {
 public:
  static constexpr std::size_t kObjects = 5;

  /// An object that stays as it is while somebody holds it. Moves only; ends in any thread, before the exchange does.
  class Reader {
   public:
    Reader(Reader&& other) noexcept : object_(std::exchange(other.object_, nullptr)), count_(other.count_) {}
    Reader& operator=(Reader&& other) noexcept {
      std::swap(object_, other.object_);
      std::swap(count_, other.count_);
      return *this;
    }
    ~Reader() {
      if (object_ != nullptr) {
        count_->fetch_sub(1);
      }
    }

    const T& operator*() const { return *object_; }
    const T* operator->() const { return object_; }

   private:
    friend class ViewExchange;
    Reader(const T& object, std::atomic<int>& count) : object_(&object), count_(&count) {}

    const T* object_;
    std::atomic<int>* count_;
  };

  Reader read() const {
    for (;;) {
      const std::size_t i = shown_.load();
      counts_[i].fetch_add(1);
      if (shown_.load() == i) {
        return {objects_[i], counts_[i]};
      }
      counts_[i].fetch_sub(1);
    }
  }

  /// Returns an object to write to, with whatever an earlier publish() left in it; nullptr where all are being looked at.
  T* begin() {
    for (std::size_t i = 0; i < kObjects; ++i) {
      if (i != shown_.load() && counts_[i].load() == 0) {
        written_ = i;
        return &objects_[i];
      }
    }
    return nullptr;
  }

  /// Shows what begin() gave.
  void publish() { shown_.store(written_); }

 private:
  std::array<T, kObjects> objects_{};
  mutable std::array<std::atomic<int>, kObjects> counts_{};  // readers of each; written by readers, read by the writer
  std::atomic<std::size_t> shown_{0};                        // written by the writer
  std::size_t written_ = 0;                                  // the writer's own
};

}  // namespace slamd::client
