#include "drivers/clouds/raw_cloud.hpp"

#include "core/base/bytes.hpp"

namespace slamd::clouds {

namespace {

template <typename To, typename T>
To load(const RawCloud& cloud, std::size_t offset) {
  return static_cast<To>(cloud.big_endian ? load_be<T>(cloud.bytes, offset)
                                          : load_le<T>(cloud.bytes, offset));
}

template <typename To>
To value_at(const RawCloud& cloud, NumberType type, std::size_t offset) {
  switch (type) {
    case NumberType::kInt8:
      return load<To, std::int8_t>(cloud, offset);
    case NumberType::kUint8:
      return load<To, std::uint8_t>(cloud, offset);
    case NumberType::kInt16:
      return load<To, std::int16_t>(cloud, offset);
    case NumberType::kUint16:
      return load<To, std::uint16_t>(cloud, offset);
    case NumberType::kInt32:
      return load<To, std::int32_t>(cloud, offset);
    case NumberType::kUint32:
      return load<To, std::uint32_t>(cloud, offset);
    case NumberType::kInt64:
      return load<To, std::int64_t>(cloud, offset);
    case NumberType::kUint64:
      return load<To, std::uint64_t>(cloud, offset);
    case NumberType::kFloat32:
      return load<To, float>(cloud, offset);
    case NumberType::kFloat64:
      return load<To, double>(cloud, offset);
  }
  return To{};
}

}  // namespace

std::string_view name_of(CloudRefusal reason) {
  switch (reason) {
    case CloudRefusal::kUnreadable:
      return "unreadable";
    case CloudRefusal::kBadHeader:
      return "bad_header";
    case CloudRefusal::kUnsupported:
      return "unsupported";
    case CloudRefusal::kTruncated:
      return "truncated";
    case CloudRefusal::kBadCompression:
      return "bad_compression";
    case CloudRefusal::kBadNumber:
      return "bad_number";
    case CloudRefusal::kNoCoordinates:
      return "no_coordinates";
    case CloudRefusal::kBadTime:
      return "bad_time";
    case CloudRefusal::kNoStamp:
      return "no_stamp";
    case CloudRefusal::kStampNotIncreasing:
      return "stamp_not_increasing";
  }
  return "?";
}

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::kInt8:
    case NumberType::kUint8:
      return 1;
    case NumberType::kInt16:
    case NumberType::kUint16:
      return 2;
    case NumberType::kInt32:
    case NumberType::kUint32:
    case NumberType::kFloat32:
      return 4;
    case NumberType::kInt64:
    case NumberType::kUint64:
    case NumberType::kFloat64:
      return 8;
  }
  return 0;
}

bool is_integer(NumberType type) {
  return type != NumberType::kFloat32 && type != NumberType::kFloat64;
}

const Column* RawCloud::find(std::string_view name) const {
  for (const Column& column : columns) {
    if (column.name == name) {
      return &column;
    }
  }
  return nullptr;
}

double RawCloud::number(const Column& column, std::size_t point) const {
  return value_at<double>(*this, column.type, column.first + point * column.stride);
}

std::int64_t RawCloud::integer(const Column& column, std::size_t point) const {
  SLAMD_ASSERT(is_integer(column.type));
  return value_at<std::int64_t>(*this, column.type, column.first + point * column.stride);
}

std::optional<CloudRefusal> parse_bin(std::span<const std::byte> file, RawCloud& cloud) {
  constexpr std::size_t kPointBytes = 16;
  cloud = RawCloud{};
  if (file.size() % kPointBytes != 0) {
    return CloudRefusal::kTruncated;
  }
  cloud.points = file.size() / kPointBytes;
  cloud.bytes = file;
  const char* const names[] = {"x", "y", "z", "intensity"};
  for (std::size_t i = 0; i < 4; ++i) {
    cloud.columns.push_back({names[i], NumberType::kFloat32, 4 * i, kPointBytes});
  }
  return std::nullopt;
}

}  // namespace slamd::clouds
