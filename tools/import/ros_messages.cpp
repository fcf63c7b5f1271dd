#include "tools/import/ros_messages.hpp"

#include <cmath>
#include <string>

#include "core/base/bytes.hpp"

namespace slamd::importing {

namespace {

using clouds::Column;
using clouds::NumberType;

constexpr std::size_t kVelodyneBytes = 1206;
constexpr std::size_t kVelodynePacketBytes = 8 + kVelodyneBytes;
constexpr std::size_t kLivoxPointBytes = 19;
constexpr std::uint32_t kMaxFields = 256;

/// Reads values off the front; once something is missing, `good` is false and all values are zero.
class Message {
 public:
  explicit Message(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool good() const { return good_; }

  std::size_t left() const { return bytes_.size(); }

  std::span<const std::byte> take(std::size_t size) {
    if (!good_ || size > bytes_.size()) {
      good_ = false;
      return {};
    }
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  template <typename T>
  T number() {
    const auto bytes = take(sizeof(T));
    return bytes.empty() ? T{} : load_le<T>(bytes, 0);
  }

  std::string_view text() {
    const auto bytes = take(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  Stamp stamp() {
    const auto seconds = number<std::uint32_t>();
    const auto nanoseconds = number<std::uint32_t>();
    good_ = good_ && nanoseconds < 1'000'000'000;
    return Stamp{} + std::chrono::seconds{seconds} + Duration{nanoseconds};
  }

  /// std_msgs/Header: sequence number, stamp, frame.
  Stamp header() {
    number<std::uint32_t>();
    const Stamp result = stamp();
    text();
    return result;
  }

 private:
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

Eigen::Vector3d vector3(Message& message) {
  const double x = message.number<double>();
  const double y = message.number<double>();
  const double z = message.number<double>();
  return {x, y, z};
}

/// sensor_msgs/PointField's datatype.
std::optional<NumberType> number_type(std::uint8_t datatype) {
  constexpr NumberType kTypes[] = {NumberType::kInt8,
                                   NumberType::kUint8,
                                   NumberType::kInt16,
                                   NumberType::kUint16,
                                   NumberType::kInt32,
                                   NumberType::kUint32,
                                   NumberType::kFloat32,
                                   NumberType::kFloat64};
  return datatype >= 1 && datatype <= std::size(kTypes) ? std::optional(kTypes[datatype - 1])
                                                        : std::nullopt;
}

bool read_fields(Message& message, std::vector<Column>& columns) {
  const auto count = message.number<std::uint32_t>();
  if (count > kMaxFields) {
    return false;
  }
  for (std::uint32_t i = 0; i < count && message.good(); ++i) {
    Column column;
    column.name = message.text();
    column.first = message.number<std::uint32_t>();
    const auto type = number_type(message.number<std::uint8_t>());
    message.number<std::uint32_t>();  // count: the first value is the one that is read
    if (!type) {
      return false;
    }
    column.type = *type;
    columns.push_back(column);
  }
  return message.good();
}

}  // namespace

std::optional<sensor::ImuSample> parse_imu(std::span<const std::byte> bytes) {
  constexpr std::size_t kCovariance = 9 * sizeof(double);
  Message message(bytes);
  sensor::ImuSample sample;
  sample.stamp = message.header();
  message.take(4 * sizeof(double));  // orientation
  message.take(kCovariance);
  sample.angular_rate_radps = vector3(message);
  message.take(kCovariance);
  sample.specific_force_mps2 = vector3(message);
  message.take(kCovariance);
  const bool finite =
      sample.angular_rate_radps.allFinite() && sample.specific_force_mps2.allFinite();
  return message.good() && message.left() == 0 && finite ? std::optional(sample) : std::nullopt;
}

std::optional<CloudMessage> parse_point_cloud2(std::span<const std::byte> bytes) {
  Message message(bytes);
  CloudMessage result;
  result.stamp = message.header();
  const std::size_t height = message.number<std::uint32_t>();
  const std::size_t width = message.number<std::uint32_t>();
  if (!read_fields(message, result.cloud.columns)) {
    return std::nullopt;
  }
  result.cloud.big_endian = message.number<std::uint8_t>() != 0;
  const std::size_t point_step = message.number<std::uint32_t>();
  const std::size_t row_step = message.number<std::uint32_t>();
  const auto data = message.take(message.number<std::uint32_t>());
  message.number<std::uint8_t>();  // is_dense: not to be relied on
  // All below are 32-bit values, so that none of the products overflows.
  const bool packed = height <= 1 || row_step == width * point_step;
  if (!message.good() || point_step == 0 || !packed || height * width > data.size() / point_step) {
    return std::nullopt;
  }
  for (Column& column : result.cloud.columns) {
    if (column.first + size_of(column.type) > point_step) {
      return std::nullopt;
    }
    column.stride = point_step;
  }
  result.cloud.points = height * width;
  result.cloud.height = height;
  result.cloud.bytes = data;
  return result;
}

std::optional<CloudMessage> parse_livox_custom(std::span<const std::byte> bytes) {
  Message message(bytes);
  CloudMessage result;
  result.stamp = message.header();
  message.number<std::uint64_t>();  // timebase: the same as the header's stamp
  const auto announced = message.number<std::uint32_t>();
  message.take(4);  // lidar_id, rsvd
  const std::size_t points = message.number<std::uint32_t>();
  if (!message.good() || announced != points || message.left() != points * kLivoxPointBytes) {
    return std::nullopt;
  }
  const auto add = [&result](const char* name, NumberType type, std::size_t first) {
    result.cloud.columns.push_back({name, type, first, kLivoxPointBytes});
  };
  add("offset_time_ns", NumberType::kUint32, 0);
  add("x", NumberType::kFloat32, 4);
  add("y", NumberType::kFloat32, 8);
  add("z", NumberType::kFloat32, 12);
  add("reflectivity", NumberType::kUint8, 16);
  add("tag", NumberType::kUint8, 17);
  add("line", NumberType::kUint8, 18);
  result.cloud.points = points;
  result.cloud.bytes = message.take(points * kLivoxPointBytes);
  return result;
}

bool parse_velodyne_scan(
    std::span<const std::byte> bytes,
    const std::function<void(Stamp stamp, std::span<const std::byte> payload)>& packet) {
  Message message(bytes);
  message.header();
  const std::size_t packets = message.number<std::uint32_t>();
  if (!message.good() || message.left() != packets * kVelodynePacketBytes) {
    return false;
  }
  Message checked = message;
  for (std::size_t i = 0; i < packets; ++i) {
    checked.stamp();
    checked.take(kVelodyneBytes);
  }
  for (std::size_t i = 0; i < packets && checked.good(); ++i) {
    const Stamp stamp = message.stamp();
    packet(stamp, message.take(kVelodyneBytes));
  }
  return checked.good();
}

}  // namespace slamd::importing
