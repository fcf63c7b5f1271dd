#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace slamd::clouds {

/// Reads lines and words off the front of a file in memory.
class TextCursor {
 public:
  explicit TextCursor(std::span<const std::byte> bytes)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

  /// Takes the next line, without its end; nothing at the end of the file.
  std::optional<std::string_view> line() {
    if (at_ >= text_.size()) {
      return std::nullopt;
    }
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (!line.empty() && line.back() == '\r') {
      line.remove_suffix(1);
    }
    return line;
  }

  /// Takes the next word, over line ends; empty at the end of the file.
  std::string_view word() {
    const std::size_t begin = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n", begin), text_.size());
    at_ = end;
    return text_.substr(begin, end - begin);
  }

  std::size_t offset() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

/// Takes the first word off a line.
inline std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Reads a whole word as a number; nan and inf are numbers here.
template <typename T>
std::optional<T> parse_word(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
  }
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && !word.empty()
             ? std::optional(value)
             : std::nullopt;
}

}  // namespace slamd::clouds
