#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <type_traits>

#include "core/base/assert.hpp"

namespace slamd {

/// Holds up to kCapacity values inside the object itself.
/// Errors: push_back and resize past the capacity are programmer errors; try_push_back tells instead.
/// Real-time: never allocates.
template <typename T, std::size_t kCapacity>
class FixedVector {
  static_assert(std::is_trivially_copyable_v<T>, "elements are copied as bytes between threads");

 public:
  using value_type = T;

  FixedVector() = default;

  FixedVector(std::initializer_list<T> values) {
    for (const T& value : values) {
      push_back(value);
    }
  }

  static constexpr std::size_t capacity() { return kCapacity; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == kCapacity; }
  void clear() { size_ = 0; }

  void resize(std::size_t size) {
    SLAMD_ASSERT(size <= kCapacity);
    for (std::size_t i = size_; i < size; ++i) {
      values_[i] = T{};
    }
    size_ = size;
  }

  void push_back(const T& value) {
    SLAMD_ASSERT(size_ < kCapacity);
    values_[size_++] = value;
  }

  /// Appends unless full; returns whether it did.
  bool try_push_back(const T& value) {
    if (full()) {
      return false;
    }
    values_[size_++] = value;
    return true;
  }

  T& operator[](std::size_t i) { return values_[i]; }
  const T& operator[](std::size_t i) const { return values_[i]; }
  T& back() { return values_[size_ - 1]; }
  const T& back() const { return values_[size_ - 1]; }
  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  T* begin() { return values_.data(); }
  T* end() { return values_.data() + size_; }
  const T* begin() const { return values_.data(); }
  const T* end() const { return values_.data() + size_; }

  std::span<const T> view() const { return {values_.data(), size_}; }

 private:
  std::size_t size_ = 0;
  std::array<T, kCapacity> values_;
};

}  // namespace slamd
