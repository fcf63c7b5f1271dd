#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/base/assert.hpp"

namespace slamd {

namespace detail {

template <typename T, std::endian kOrder>
T load(std::span<const std::byte> bytes, std::size_t offset) {
  SLAMD_ASSERT(offset + sizeof(T) <= bytes.size());
  std::byte raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    raw[i] = bytes[kOrder == std::endian::native ? offset + i : offset + sizeof(T) - 1 - i];
  }
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

template <typename T, std::endian kOrder>
void store(std::span<std::byte> bytes, std::size_t offset, T value) {
  SLAMD_ASSERT(offset + sizeof(T) <= bytes.size());
  std::byte raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[kOrder == std::endian::native ? offset + i : offset + sizeof(T) - 1 - i] = raw[i];
  }
}

template <typename T>
concept Number = std::integral<T> || std::floating_point<T>;

}  // namespace detail

/// Reads a little-endian number. Errors: the caller has checked the length; reading past the end aborts.
template <detail::Number T>
T load_le(std::span<const std::byte> bytes, std::size_t offset) {
  return detail::load<T, std::endian::little>(bytes, offset);
}

/// Reads a big-endian number. Errors: as load_le.
template <detail::Number T>
T load_be(std::span<const std::byte> bytes, std::size_t offset) {
  return detail::load<T, std::endian::big>(bytes, offset);
}

/// Writes a little-endian number. Errors: as load_le.
template <detail::Number T>
void store_le(std::span<std::byte> bytes, std::size_t offset, T value) {
  detail::store<T, std::endian::little>(bytes, offset, value);
}

/// Writes a big-endian number. Errors: as load_le.
template <detail::Number T>
void store_be(std::span<std::byte> bytes, std::size_t offset, T value) {
  detail::store<T, std::endian::big>(bytes, offset, value);
}

}  // namespace slamd
