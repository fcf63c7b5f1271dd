#include "drivers/recording/candump.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>

#include "drivers/recording/packet.hpp"
#include "drivers/recording/seconds.hpp"

namespace slamd::recording {

using transport::CanFrame;

namespace {

constexpr std::size_t kShortDigits = 3;
constexpr std::size_t kLongDigits = 8;
constexpr std::uint32_t kHighestShortId = 0x7FF;
constexpr std::uint32_t kHighestLongId = 0x1FFF'FFFF;
/// Set in the id of an error frame, as the kernel has it.
constexpr std::uint32_t kErrorFlag = 0x2000'0000;

/// Takes what stands before the first of `end`, and that; nothing when it is not there.
std::optional<std::string_view> take_until(std::string_view& text, char end) {
  const std::size_t at = text.find(end);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view word = text.substr(0, at);
  text.remove_prefix(at + 1);
  return word;
}

std::optional<std::uint32_t> hex_number(std::string_view digits) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, 16);
  return error == std::errc() && end == digits.data() + digits.size() ? std::optional(number) : std::nullopt;
}

/// Tells whether the kernel would have an interface of this name.
bool is_interface(std::string_view name) {
  constexpr std::size_t kLongest = 15;
  return !name.empty() && name.size() <= kLongest && std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c < 0x7F; });
}

bool read_data(std::string_view digits, CanFrame& frame) {
  if (digits.size() % 2 != 0 || digits.size() > 2 * frame.data.size()) {
    return false;
  }
  frame.size = static_cast<std::uint8_t>(digits.size() / 2);
  frame.data = {};
  for (std::size_t i = 0; i < frame.size; ++i) {
    const std::optional<std::uint32_t> byte = hex_number(digits.substr(2 * i, 2));
    if (!byte) {
      return false;
    }
    frame.data[i] = static_cast<std::byte>(*byte);
  }
  return true;
}

}  // namespace

CanLine parse_candump(std::string_view line, CanFrame& frame, std::string_view& interface) {
  if (!line.starts_with('(')) {
    return CanLine::kMalformed;
  }
  line.remove_prefix(1);
  const auto seconds = take_until(line, ')');
  const auto stamp = seconds ? parse_seconds(*seconds) : std::nullopt;
  if (!stamp || !line.starts_with(' ')) {
    return CanLine::kMalformed;
  }
  line.remove_prefix(1);
  const auto name = take_until(line, ' ');
  const auto digits = name ? take_until(line, '#') : std::nullopt;
  const auto id = digits ? hex_number(*digits) : std::nullopt;
  if (!id || !is_interface(*name) || (digits->size() != kShortDigits && digits->size() != kLongDigits)) {
    return CanLine::kMalformed;
  }
  if (line.starts_with('#') || line.starts_with('R') || (digits->size() == kLongDigits && (*id & kErrorFlag) != 0)) {
    return CanLine::kOther;
  }
  frame.is_extended = digits->size() == kLongDigits;
  frame.id = *id;
  frame.received = *stamp;
  if (*id > (frame.is_extended ? kHighestLongId : kHighestShortId) || !read_data(line.substr(0, line.find_first_of(" \r")), frame)) {
    return CanLine::kMalformed;
  }
  interface = *name;
  return CanLine::kFrame;
}

std::string candump_line(std::string_view interface, const CanFrame& frame) {
  const auto total_us = frame.received.time_since_epoch().count() / 1000;
  char text[96];
  int size = std::snprintf(text, sizeof text, "(%lld.%06lld) %.*s ", static_cast<long long>(total_us / 1'000'000),
                           static_cast<long long>(total_us % 1'000'000), static_cast<int>(interface.size()), interface.data());
  std::string line(text, static_cast<std::size_t>(size));
  size = std::snprintf(text, sizeof text, frame.is_extended ? "%08X#" : "%03X#", frame.id);
  line.append(text, static_cast<std::size_t>(size));
  for (const std::byte byte : frame.bytes()) {
    std::snprintf(text, sizeof text, "%02X", std::to_integer<unsigned>(byte));
    line += text;
  }
  return line + '\n';
}

CandumpReader::CandumpReader(const std::filesystem::path& file, std::string interface)
    : stream_(file), interface_(std::move(interface)) {
  if (!stream_ || std::filesystem::is_directory(file)) {
    throw RecordingError(file, "cannot be read");
  }
}

bool CandumpReader::next(CanFrame& frame) {
  std::string_view interface;
  while (std::getline(stream_, line_)) {
    if (line_.empty()) {
      continue;
    }
    switch (parse_candump(line_, frame, interface)) {
      case CanLine::kOther: ++counters_.other; break;
      case CanLine::kMalformed: ++counters_.malformed; break;
      case CanLine::kFrame:
        if (interface_.empty() || interface == interface_) {
          ++counters_.frames;
          return true;
        }
        ++counters_.foreign;
        break;
    }
  }
  return false;
}

}  // namespace slamd::recording
