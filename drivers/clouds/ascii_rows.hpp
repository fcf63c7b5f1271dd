#pragma once

#include <optional>
#include <span>
#include <vector>

#include "drivers/clouds/raw_cloud.hpp"
#include "drivers/clouds/text_cursor.hpp"

namespace slamd::clouds {

/// One field of an ASCII row: `words` of them stand in the row, the first one counts.
struct AsciiField {
  std::string name;
  NumberType type = NumberType::kFloat32;
  std::size_t words = 1;
};

/// Reads `points` rows into the cloud's own memory, 8 bytes a value: int64 for integers, double for
/// floats. Memory is bounded by the text that is there, whatever number of points the header names.
/// Errors: kTruncated, kBadNumber.
std::optional<CloudRefusal> parse_ascii_rows(TextCursor& text,
                                             std::span<const AsciiField> fields,
                                             std::size_t points,
                                             RawCloud& cloud);

}  // namespace slamd::clouds
