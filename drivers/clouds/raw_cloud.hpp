#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slamd::clouds {

/// Why a file gave no scan.
enum class CloudRefusal : std::uint8_t {
  kUnreadable,          // cannot be opened or read
  kBadHeader,           // not the format, or it contradicts itself
  kUnsupported,         // well-formed, but of a kind that is not read (lists among the vertices)
  kTruncated,           // fewer bytes or rows than the header promises
  kBadCompression,      // LZF data that do not unpack to what the header promises
  kBadNumber,           // ASCII text where a number should be
  kNoCoordinates,       // no x, y, z
  kBadTime,             // the points' times span more than a second
  kNoStamp,             // no stamp in the times file
  kStampNotIncreasing,  // not later than the scan before
};

inline constexpr std::size_t kCloudRefusals = 10;

std::string_view name_of(CloudRefusal reason);

enum class NumberType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
};

std::size_t size_of(NumberType type);
bool is_integer(NumberType type);

/// Where one field's values are: the value of point i begins at first + i · stride.
struct Column {
  std::string name;
  NumberType type = NumberType::kFloat32;
  std::size_t first = 0;
  std::size_t stride = 0;
};

/// A cloud file taken apart into columns, values still as in the file.
/// `bytes` points into the file's bytes, or into `unpacked`; every column's every value lies inside
/// (the parsers have checked that).
struct RawCloud {
  std::size_t points = 0;
  std::size_t height = 1;  // rows of an organised cloud
  bool big_endian = false;
  std::vector<Column> columns;
  std::span<const std::byte> bytes;
  std::vector<std::byte> unpacked;  // of compressed and ASCII files

  /// Returns the column with this name, or nullptr.
  const Column* find(std::string_view name) const;

  double number(const Column& column, std::size_t point) const;

  /// Returns the value of an integer column; unsigned 64-bit values beyond the signed range wrap.
  std::int64_t integer(const Column& column, std::size_t point) const;
};

/// Takes a KITTI or MulRan .bin apart: x, y, z, intensity as little-endian floats, no header.
/// The result refers to `file`. Errors: kTruncated when the size is no multiple of a point's.
std::optional<CloudRefusal> parse_bin(std::span<const std::byte> file, RawCloud& cloud);

}  // namespace slamd::clouds
