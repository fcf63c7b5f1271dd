#include "drivers/clouds/ply.hpp"

#include <array>

#include "drivers/clouds/ascii_rows.hpp"
#include "drivers/clouds/text_cursor.hpp"

namespace slamd::clouds {

namespace {

constexpr std::size_t kMaxProperties = 256;

struct Header {
  std::string_view format;
  std::optional<std::size_t> points;
  std::vector<AsciiField> properties;
  bool in_vertices = false;
  bool vertices_done = false;
};

std::optional<NumberType> number_type(std::string_view name) {
  struct Named {
    std::string_view name;
    NumberType type;
  };

  static constexpr std::array kNames = {Named{"char", NumberType::kInt8},
                                        Named{"int8", NumberType::kInt8},
                                        Named{"uchar", NumberType::kUint8},
                                        Named{"uint8", NumberType::kUint8},
                                        Named{"short", NumberType::kInt16},
                                        Named{"int16", NumberType::kInt16},
                                        Named{"ushort", NumberType::kUint16},
                                        Named{"uint16", NumberType::kUint16},
                                        Named{"int", NumberType::kInt32},
                                        Named{"int32", NumberType::kInt32},
                                        Named{"uint", NumberType::kUint32},
                                        Named{"uint32", NumberType::kUint32},
                                        Named{"int64", NumberType::kInt64},
                                        Named{"uint64", NumberType::kUint64},
                                        Named{"float", NumberType::kFloat32},
                                        Named{"float32", NumberType::kFloat32},
                                        Named{"double", NumberType::kFloat64},
                                        Named{"float64", NumberType::kFloat64}};
  for (const Named& named : kNames) {
    if (named.name == name) {
      return named.type;
    }
  }
  return std::nullopt;
}

std::optional<CloudRefusal> read_element(std::string_view line, Header& header) {
  const std::string_view name = take_word(line);
  const auto count = parse_word<std::size_t>(take_word(line));
  if (!count) {
    return CloudRefusal::kBadHeader;
  }
  if (name == "vertex") {
    if (header.points) {
      return CloudRefusal::kBadHeader;
    }
    header.points = count;
    header.in_vertices = true;
    return std::nullopt;
  }
  header.in_vertices = false;
  return header.points || *count == 0 ? std::nullopt : std::optional(CloudRefusal::kUnsupported);
}

std::optional<CloudRefusal> read_property(std::string_view line, Header& header) {
  if (!header.in_vertices) {
    return std::nullopt;
  }
  const std::string_view type_name = take_word(line);
  if (type_name == "list") {
    return CloudRefusal::kUnsupported;
  }
  const auto type = number_type(type_name);
  const std::string_view name = take_word(line);
  if (!type || name.empty() || header.properties.size() == kMaxProperties) {
    return CloudRefusal::kBadHeader;
  }
  header.properties.push_back({std::string(name), *type, 1});
  return std::nullopt;
}

std::optional<CloudRefusal> read_header(TextCursor& text, Header& header) {
  if (text.line() != "ply") {
    return CloudRefusal::kBadHeader;
  }
  for (auto line = text.line(); line; line = text.line()) {
    const std::string_view key = take_word(*line);
    std::optional<CloudRefusal> refusal;
    if (key == "end_header") {
      const bool whole = header.points && !header.properties.empty() && !header.format.empty();
      return whole ? std::nullopt : std::optional(CloudRefusal::kBadHeader);
    }
    if (key == "format") {
      header.format = take_word(*line);
    } else if (key == "element") {
      refusal = read_element(*line, header);
    } else if (key == "property") {
      refusal = read_property(*line, header);
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      refusal = CloudRefusal::kBadHeader;
    }
    if (refusal) {
      return refusal;
    }
  }
  return CloudRefusal::kBadHeader;
}

}  // namespace

std::optional<CloudRefusal> parse_ply(std::span<const std::byte> file, RawCloud& cloud) {
  cloud = RawCloud{};
  TextCursor text(file);
  Header header;
  if (const auto refusal = read_header(text, header)) {
    return refusal;
  }
  if (header.format == "ascii") {
    return parse_ascii_rows(text, header.properties, *header.points, cloud);
  }
  cloud.big_endian = header.format == "binary_big_endian";
  if (!cloud.big_endian && header.format != "binary_little_endian") {
    return CloudRefusal::kUnsupported;
  }
  std::size_t record = 0;
  for (const AsciiField& property : header.properties) {
    record += size_of(property.type);
  }
  const std::span<const std::byte> body = file.subspan(text.offset());
  if (*header.points > body.size() / record) {
    return CloudRefusal::kTruncated;
  }
  std::size_t first = 0;
  for (const AsciiField& property : header.properties) {
    cloud.columns.push_back({property.name, property.type, first, record});
    first += size_of(property.type);
  }
  cloud.points = *header.points;
  cloud.bytes = body.first(cloud.points * record);
  return std::nullopt;
}

}  // namespace slamd::clouds
