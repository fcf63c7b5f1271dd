#include "drivers/clouds/ascii_rows.hpp"

#include <bit>
#include <cstdint>

#include "core/base/bytes.hpp"

namespace slamd::clouds {

namespace {

constexpr std::size_t kValueBytes = 8;

std::optional<std::uint64_t> value_bits(std::string_view word, NumberType type) {
  if (type == NumberType::kUint64) {
    return parse_word<std::uint64_t>(word);
  }
  if (is_integer(type)) {
    const auto value = parse_word<std::int64_t>(word);
    return value ? std::optional(static_cast<std::uint64_t>(*value)) : std::nullopt;
  }
  const auto value = parse_word<double>(word);
  return value ? std::optional(std::bit_cast<std::uint64_t>(*value)) : std::nullopt;
}

void append(std::vector<std::byte>& bytes, std::uint64_t bits) {
  bytes.resize(bytes.size() + kValueBytes);
  store_le(std::span(bytes), bytes.size() - kValueBytes, bits);
}

NumberType stored_type(NumberType type) {
  if (type == NumberType::kUint64) {
    return type;
  }
  return is_integer(type) ? NumberType::kInt64 : NumberType::kFloat64;
}

}  // namespace

std::optional<CloudRefusal> parse_ascii_rows(TextCursor& text,
                                             std::span<const AsciiField> fields,
                                             std::size_t points,
                                             RawCloud& cloud) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    cloud.columns.push_back({fields[i].name,
                             stored_type(fields[i].type),
                             kValueBytes * i,
                             kValueBytes * fields.size()});
  }
  for (std::size_t row = 0; row < points; ++row) {
    for (const AsciiField& field : fields) {
      for (std::size_t i = 0; i < field.words; ++i) {
        const std::string_view word = text.word();
        if (word.empty()) {
          return CloudRefusal::kTruncated;
        }
        const auto bits = value_bits(word, field.type);
        if (!bits) {
          return CloudRefusal::kBadNumber;
        }
        if (i == 0) {
          append(cloud.unpacked, *bits);
        }
      }
    }
  }
  cloud.points = points;
  cloud.big_endian = false;
  cloud.bytes = cloud.unpacked;
  return std::nullopt;
}

}  // namespace slamd::clouds
