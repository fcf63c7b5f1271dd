#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <sstream>
#include <string>

#include "tests/hex/hex.hpp"

namespace slamd::imu {

using hex::Bytes;
using hex::from_hex;
using hex::to_hex;

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline Bytes bytes_of(const std::filesystem::path& file) {
  const std::string text = text_of(file);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Calls use(piece) for the bytes in pieces of 1 to longest bytes.
template <typename Use>
void in_pieces(std::span<const std::byte> bytes, std::size_t longest, Use&& use) {
  std::mt19937 random(3);
  while (!bytes.empty()) {
    const std::size_t piece = std::min<std::size_t>(bytes.size(), 1 + random() % longest);
    use(bytes.first(piece));
    bytes = bytes.subspan(piece);
  }
}

}  // namespace slamd::imu
