#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/plot/palette.hpp"

namespace slamd::plot {

/// A picture of at most 256 colours.  Shapes: pixels[height * width], rows from the top.
struct IndexedImage {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<Rgb> palette;
  std::vector<std::uint8_t> pixels;
};

/// Returns the picture as the bytes of a PNG file.
/// Errors: throws std::runtime_error when libpng refuses it (no pixels, too many colours).
std::vector<std::byte> png_of(const IndexedImage& image);

/// Returns bytes as base64 (RFC 4648, padded), for data: addresses.
std::string base64(std::span<const std::byte> bytes);

}  // namespace slamd::plot
