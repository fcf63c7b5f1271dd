#pragma once

#include <algorithm>
#include <array>
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
  Text(std::string_view text) { *this = text; }  // NOLINT(google-explicit-constructor): a text is a text
  Text(const char* text) : Text(std::string_view(text)) {}  // NOLINT(google-explicit-constructor): likewise

  Text& operator=(std::string_view text) {
    std::size_t size = std::min(text.size(), kCapacity);
    while (size > 0 && size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) {
      --size;
    }
    std::copy_n(text.data(), size, characters_.data());
    size_ = static_cast<unsigned char>(size);
    return *this;
  }

  static constexpr std::size_t capacity() { return kCapacity; }
  bool empty() const { return size_ == 0; }
  std::string_view view() const { return {characters_.data(), size_}; }
  operator std::string_view() const { return view(); }  // NOLINT(google-explicit-constructor): likewise

 private:
  std::array<char, kCapacity> characters_{};
  unsigned char size_ = 0;
};

}  // namespace slamd::bus
