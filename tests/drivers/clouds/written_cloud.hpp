#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.hpp"

namespace slamd::clouds {

/// Builds cloud files in memory.
class Written {
 public:
  explicit Written(std::string_view text = "") { add(text); }

  Written& add(std::string_view text) {
    for (const char c : text) {
      bytes_.push_back(static_cast<std::byte>(c));
    }
    return *this;
  }

  template <typename T>
  Written& add_le(T value) {
    bytes_.resize(bytes_.size() + sizeof(T));
    store_le(std::span(bytes_), bytes_.size() - sizeof(T), value);
    return *this;
  }

  template <typename T>
  Written& add_be(T value) {
    bytes_.resize(bytes_.size() + sizeof(T));
    store_be(std::span(bytes_), bytes_.size() - sizeof(T), value);
    return *this;
  }

  Written& add(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Packs with LZF: greedy, with a table of three-byte sequences, as liblzf does.
inline std::vector<std::byte> lzf_pack(std::span<const std::byte> in) {
  std::vector<std::byte> out;
  std::vector<std::size_t> last(1 << 16, SIZE_MAX);
  std::vector<std::byte> literals;
  const auto flush = [&] {
    if (!literals.empty()) {
      out.push_back(static_cast<std::byte>(literals.size() - 1));
      out.insert(out.end(), literals.begin(), literals.end());
      literals.clear();
    }
  };
  std::size_t i = 0;
  while (i < in.size()) {
    std::size_t length = 0;
    std::size_t from = SIZE_MAX;
    if (i + 2 < in.size()) {
      const auto key = (std::to_integer<std::size_t>(in[i]) * 2654435761U ^
                        std::to_integer<std::size_t>(in[i + 1]) * 40503U ^
                        std::to_integer<std::size_t>(in[i + 2]) * 97U) &
                       0xFFFF;
      from = last[key];
      last[key] = i;
      if (from != SIZE_MAX && i - from <= 8192) {
        while (length < 264 && i + length < in.size() && in[from + length] == in[i + length]) {
          ++length;
        }
      }
    }
    if (length < 3) {
      literals.push_back(in[i++]);
      if (literals.size() == 32) {
        flush();
      }
      continue;
    }
    flush();
    const std::size_t distance = i - from - 1;
    const std::size_t code = length - 2;
    out.push_back(static_cast<std::byte>((code < 7 ? code << 5 : 7U << 5) | (distance >> 8)));
    if (code >= 7) {
      out.push_back(static_cast<std::byte>(code - 7));
    }
    out.push_back(static_cast<std::byte>(distance));
    i += length;
  }
  flush();
  return out;
}

}  // namespace slamd::clouds
