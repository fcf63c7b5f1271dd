#include "tools/plot/svg.hpp"

#include <array>
#include <cstdio>

namespace slamd::plot {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string coordinate(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  std::string result = text.data();
  result.erase(result.find_last_not_of('0') + 1);
  if (result.back() == '.') {
    result.pop_back();
  }
  return result == "-0" ? "0" : result;
}

std::string text_at(double x, double y, const std::string& text, const char* anchor, double size) {
  return "<text class=\"ink\" fill=\"#222\" x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) +
         "\" font-size=\"" + coordinate(size) + "\" text-anchor=\"" + anchor + "\">" +
         escaped(text) + "</text>\n";
}

std::string document(double width, double height, const std::string& alt, const std::string& body) {
  const std::string w = coordinate(width);
  const std::string h = coordinate(height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 " + w + " " + h +
         "\" width=\"" + w + "\" height=\"" + h + "\" role=\"img\" aria-label=\"" + escaped(alt) +
         "\" font-family=\"system-ui, 'DejaVu Sans', sans-serif\">\n<rect class=\"paper\" "
         "width=\"" +
         w + "\" height=\"" + h + "\" fill=\"#fff\"/>\n" + body + "</svg>\n";
}

}  // namespace slamd::plot
