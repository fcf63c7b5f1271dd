#include "drivers/clouds/pcd.hpp"

#include <cstdint>

#include "core/base/bytes.hpp"
#include "drivers/clouds/ascii_rows.hpp"
#include "drivers/clouds/lzf.hpp"
#include "drivers/clouds/text_cursor.hpp"

namespace slamd::clouds {

namespace {

constexpr std::size_t kMaxFields = 256;
constexpr std::size_t kMaxCount = 4096;  // values of one field in one point

struct Header {
  std::vector<std::string> names;
  std::vector<std::size_t> sizes;
  std::vector<char> types;
  std::vector<std::size_t> counts;
  std::optional<std::size_t> width;
  std::optional<std::size_t> height;
  std::optional<std::size_t> points;
  std::string encoding;
};

bool read_sizes(std::string_view line, std::vector<std::size_t>& sizes) {
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    const auto value = parse_word<std::size_t>(word);
    if (!value || *value == 0 || sizes.size() == kMaxFields) {
      return false;
    }
    sizes.push_back(*value);
  }
  return true;
}

bool read_number(std::string_view line, std::optional<std::size_t>& number) {
  number = parse_word<std::size_t>(take_word(line));
  return number.has_value();
}

/// Reads one header line; returns whether it could be understood.
bool read_line(std::string_view line, Header& header) {
  const std::string_view key = take_word(line);
  if (key == "FIELDS" || key == "COLUMNS") {
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      header.names.emplace_back(word);
    }
    return header.names.size() <= kMaxFields;
  }
  if (key == "TYPE") {
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      header.types.push_back(word.size() == 1 ? word.front() : '?');
    }
    return true;
  }
  if (key == "SIZE") {
    return read_sizes(line, header.sizes);
  }
  if (key == "COUNT") {
    return read_sizes(line, header.counts);
  }
  if (key == "WIDTH") {
    return read_number(line, header.width);
  }
  if (key == "HEIGHT") {
    return read_number(line, header.height);
  }
  if (key == "POINTS") {
    return read_number(line, header.points);
  }
  if (key == "DATA") {
    header.encoding = take_word(line);
    return true;
  }
  return key == "VERSION" || key == "VIEWPOINT" || key.empty() || key.front() == '#';
}

std::optional<NumberType> number_type(char type, std::size_t size) {
  switch (type) {
    case 'F':
      return size == 4 ? std::optional(NumberType::kFloat32)
                       : (size == 8 ? std::optional(NumberType::kFloat64) : std::nullopt);
    case 'I':
    case 'U': {
      const bool is_signed = type == 'I';
      switch (size) {
        case 1:
          return is_signed ? NumberType::kInt8 : NumberType::kUint8;
        case 2:
          return is_signed ? NumberType::kInt16 : NumberType::kUint16;
        case 4:
          return is_signed ? NumberType::kInt32 : NumberType::kUint32;
        case 8:
          return is_signed ? NumberType::kInt64 : NumberType::kUint64;
        default:
          return std::nullopt;
      }
    }
    default:
      return std::nullopt;
  }
}

/// Fills in what may be left out, and refuses what contradicts itself.
bool complete(Header& header) {
  const std::size_t fields = header.names.size();
  if (header.counts.empty()) {
    header.counts.assign(fields, 1);
  }
  for (const std::size_t count : header.counts) {
    if (count > kMaxCount) {
      return false;
    }
  }
  if (!header.points && header.width) {
    const std::size_t height = header.height.value_or(1);
    if (height != 0 && *header.width > SIZE_MAX / height) {
      return false;
    }
    header.points = *header.width * height;
  }
  const bool grid_agrees =
      !header.width || !header.height || *header.height == 0 ||
      (*header.points % *header.height == 0 && *header.points / *header.height == *header.width);
  return fields > 0 && header.sizes.size() == fields && header.types.size() == fields &&
         header.counts.size() == fields && header.points && grid_agrees;
}

bool read_header(TextCursor& text, Header& header) {
  while (header.encoding.empty()) {
    const auto line = text.line();
    if (!line || !read_line(*line, header)) {
      return false;
    }
  }
  return complete(header);
}

/// A point's fields as they lie in a binary file.
struct Field {
  std::string name;
  NumberType type;
  std::size_t bytes;
};

std::optional<CloudRefusal> parse_binary(std::span<const std::byte> body,
                                         std::span<const Field> fields,
                                         std::size_t points,
                                         RawCloud& cloud) {
  std::size_t record = 0;
  for (const Field& field : fields) {
    record += field.bytes;
  }
  if (points > body.size() / record) {
    return CloudRefusal::kTruncated;
  }
  std::size_t first = 0;
  for (const Field& field : fields) {
    cloud.columns.push_back({field.name, field.type, first, record});
    first += field.bytes;
  }
  cloud.points = points;
  cloud.bytes = body.first(points * record);
  return std::nullopt;
}

/// Compressed points lie field by field: all x, then all y.
std::optional<CloudRefusal> parse_compressed(std::span<const std::byte> body,
                                             std::span<const Field> fields,
                                             std::size_t points,
                                             RawCloud& cloud) {
  if (body.size() < 8) {
    return CloudRefusal::kTruncated;
  }
  const std::size_t packed_size = load_le<std::uint32_t>(body, 0);
  const std::size_t unpacked_size = load_le<std::uint32_t>(body, 4);
  if (packed_size > body.size() - 8) {
    return CloudRefusal::kTruncated;
  }
  std::size_t record = 0;
  for (const Field& field : fields) {
    record += field.bytes;
  }
  if (unpacked_size % record != 0 || unpacked_size / record != points ||
      unpacked_size > kLzfMaxRatio * packed_size) {
    return CloudRefusal::kBadCompression;
  }
  cloud.unpacked.resize(unpacked_size);
  if (!lzf_unpack(body.subspan(8, packed_size), cloud.unpacked)) {
    return CloudRefusal::kBadCompression;
  }
  std::size_t first = 0;
  for (const Field& field : fields) {
    cloud.columns.push_back({field.name, field.type, first, field.bytes});
    first += field.bytes * points;
  }
  cloud.points = points;
  cloud.bytes = cloud.unpacked;
  return std::nullopt;
}

}  // namespace

std::optional<CloudRefusal> parse_pcd(std::span<const std::byte> file, RawCloud& cloud) {
  cloud = RawCloud{};
  TextCursor text(file);
  Header header;
  if (!read_header(text, header)) {
    return CloudRefusal::kBadHeader;
  }
  std::vector<Field> fields;
  std::vector<AsciiField> ascii;
  for (std::size_t i = 0; i < header.names.size(); ++i) {
    const auto type = number_type(header.types[i], header.sizes[i]);
    if (!type) {
      return CloudRefusal::kBadHeader;
    }
    fields.push_back({header.names[i], *type, header.sizes[i] * header.counts[i]});
    ascii.push_back({header.names[i], *type, header.counts[i]});
  }
  cloud.height = header.height.value_or(1);
  const std::span<const std::byte> body = file.subspan(text.offset());
  if (header.encoding == "binary") {
    return parse_binary(body, fields, *header.points, cloud);
  }
  if (header.encoding == "binary_compressed") {
    return parse_compressed(body, fields, *header.points, cloud);
  }
  return header.encoding == "ascii" ? parse_ascii_rows(text, ascii, *header.points, cloud)
                                    : std::optional(CloudRefusal::kUnsupported);
}

}  // namespace slamd::clouds
