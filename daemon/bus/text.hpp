#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <string_view>

namespace slamd::bus {

/// A short text inside the object itself, so that what holds it can pass between threads as bytes.
/// Longer texts are cut, never in the middle of a UTF-8 character.
/// Real-time: never allocates.
template <std::size_t kCapacity>
class Text {
  static_assert(kCapacity < 256);

 public:
  Text() = default;

  template <std::convertible_to<std::string_view> Any>
  Text(const Any& any) {  // NOLINT(google-explicit-constructor): a text is a text
    const std::string_view text = any;
    std::size_t size = std::min(text.size(), kCapacity);
    while (size > 0 && size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) {
      --size;
    }
    std::copy_n(text.data(), size, characters_.data());
    size_ = static_cast<unsigned char>(size);
  }

  static constexpr std::size_t capacity() { return kCapacity; }
  bool empty() const { return size_ == 0; }
  std::string_view view() const { return {characters_.data(), size_}; }

 private:
  std::array<char, kCapacity> characters_{};
  unsigned char size_ = 0;
};

}  // namespace slamd::bus
