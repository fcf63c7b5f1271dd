#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/assert.hpp"

namespace slamd {

/// Holds up to a number of values that is fixed once, at construction, from the configuration.
/// Errors: push_back past the capacity is a programmer error; try_push_back tells instead.
/// Real-time: allocates in the constructor only.
template <typename T>
class BoundedVector {
 public:
  using value_type = T;

  BoundedVector() = default;

  explicit BoundedVector(std::size_t capacity) : values_(capacity) {}

  std::size_t capacity() const { return values_.size(); }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == values_.size(); }
  void clear() { size_ = 0; }

  void resize(std::size_t size) {
    SLAMD_ASSERT(size <= values_.size());
    for (std::size_t i = size_; i < size; ++i) {
      values_[i] = T{};
    }
    size_ = size;
  }

  void push_back(const T& value) {
    SLAMD_ASSERT(size_ < values_.size());
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

  /// Copies another vector's values; the capacity stays.
  void assign(std::span<const T> values) {
    SLAMD_ASSERT(values.size() <= values_.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      values_[i] = values[i];
    }
    size_ = values.size();
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

  std::span<T> view() { return {values_.data(), size_}; }
  std::span<const T> view() const { return {values_.data(), size_}; }

 private:
  std::size_t size_ = 0;
  std::vector<T> values_;
};

}  // namespace slamd
