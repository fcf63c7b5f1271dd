#pragma once

#include <string>
#include <vector>

namespace slamd::report {

/// A table of a page; the first column is flush left, the others flush right.
struct HtmlTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// Returns the table as HTML; its texts are escaped here.
std::string html_of(const HtmlTable& table);

/// The room of a figure in the grid: one cell, a whole row, or two cells one above the other.
enum class Shape { kCell, kWide, kTall };

/// Returns a picture with a caption below it.
std::string figure(const std::string& svg, const std::string& caption, Shape shape = Shape::kCell);

/// Returns a section with a heading.
std::string section(const std::string& heading, const std::string& body);

/// Returns the whole document: style sheet included, nothing fetched from elsewhere.
std::string page(const std::string& title, const std::string& body);

/// Writes a number with so many digits after the point.
std::string number(double value, int digits);

}  // namespace slamd::report
