#include "drivers/recording/seconds.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

namespace slamd::recording {

namespace {

constexpr std::int64_t kMaxSeconds = 9'200'000'000;  // so that a scan more or less does not overflow

std::optional<Stamp> parse_with_exponent(std::string_view word) {
  double seconds = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seconds);
  const bool good = error == std::errc() && end == word.data() + word.size() &&
                    std::abs(seconds) <= static_cast<double>(kMaxSeconds);
  return good ? std::optional(Stamp{} + from_seconds(seconds)) : std::nullopt;
}

}  // namespace

std::optional<Stamp> parse_seconds(std::string_view word) {
  if (word.find_first_of("eE") != std::string_view::npos) {
    return parse_with_exponent(word);
  }
  const std::size_t dot = std::min(word.find('.'), word.size());
  const std::string_view whole = word.substr(0, dot);
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  if (error != std::errc() || end != whole.data() + whole.size() || seconds > kMaxSeconds ||
      seconds < -kMaxSeconds) {
    return std::nullopt;
  }
  std::int64_t fraction_ns = 0;
  std::int64_t unit_ns = 100'000'000;
  for (std::size_t i = dot + 1; i < word.size(); ++i, unit_ns /= 10) {
    if (word[i] < '0' || word[i] > '9') {
      return std::nullopt;
    }
    fraction_ns += unit_ns * (word[i] - '0');
  }
  const bool negative = whole.front() == '-';
  return Stamp{} + std::chrono::seconds{seconds} + Duration{negative ? -fraction_ns : fraction_ns};
}

}  // namespace slamd::recording
