#include "tools/plot/palette.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace slamd::plot {

namespace {

constexpr std::array<Rgb, 8> kViridis = {{{68, 57, 131},
                                          {56, 88, 140},
                                          {45, 112, 142},
                                          {37, 138, 140},
                                          {38, 166, 130},
                                          {81, 197, 105},
                                          {155, 217, 60},
                                          {253, 231, 37}}};

std::uint8_t mix(std::uint8_t a, std::uint8_t b, double ratio) {
  return static_cast<std::uint8_t>(std::lround(a + ratio * (b - a)));
}

}  // namespace

Rgb height_colour(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double ratio = place - static_cast<double>(i);
  const Rgb& a = kViridis[i];
  const Rgb& b = kViridis[i + 1];
  return {mix(a.r, b.r, ratio), mix(a.g, b.g, ratio), mix(a.b, b.b, ratio)};
}

std::string hex(Rgb colour) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", colour.r, colour.g, colour.b);
  return text.data();
}

}  // namespace slamd::plot
