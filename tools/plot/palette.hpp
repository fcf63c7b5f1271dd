#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace slamd::plot {

/// The colours of series, in the order of their use: told apart by colour-blind eyes and on grey
/// prints. Source: Okabe and Ito (2008), without its black and yellow.
inline constexpr std::array<const char*, 6> kSeriesColours =
    {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"};

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
};

/// Returns the colour of a height, `share` from 0 (low) to 1 (high): violet, green, yellow, with
/// rising lightness. Source: nine samples of matplotlib's viridis, without its darkest tenth,
/// linearly interpolated.
Rgb height_colour(double share);

/// Returns the colour as #rrggbb.
std::string hex(Rgb colour);

}  // namespace slamd::plot
