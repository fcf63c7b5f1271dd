#pragma once

#include <string>

namespace slamd::plot {

/// Returns the text with &, <, > and quotes written as entities, for SVG and HTML alike.
std::string escaped(const std::string& text);

/// Writes a coordinate of a drawing: to a hundredth, without trailing zeros.
std::string coordinate(double value);

/// Returns a line of text. `anchor` is start, middle or end; `size` its height. The class "ink"
/// lets a page that embeds the drawing change the colour.
std::string text_at(double x,
                    double y,
                    const std::string& text,
                    const char* anchor,
                    double size = 13.0);

/// Returns the drawing around `body`, with a title for screen readers.
std::string document(double width, double height, const std::string& alt, const std::string& body);

}  // namespace slamd::plot
