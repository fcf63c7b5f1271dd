#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"

namespace slamd::importing {

/// Serializes ROS 1 messages for tests.
class RosBytes {
 public:
  template <typename T>
  RosBytes& add(T value) {
    bytes_.resize(bytes_.size() + sizeof(T));
    store_le(std::span(bytes_), bytes_.size() - sizeof(T), value);
    return *this;
  }

  RosBytes& text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size()));
    for (const char c : text) {
      bytes_.push_back(static_cast<std::byte>(c));
    }
    return *this;
  }

  RosBytes& header(std::uint32_t seconds, std::uint32_t nanoseconds) {
    return add<std::uint32_t>(7).add(seconds).add(nanoseconds).text("lidar");
  }

  RosBytes& zeros(std::size_t count) {
    bytes_.resize(bytes_.size() + count);
    return *this;
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

inline std::vector<std::byte> imu_message(std::uint32_t s, std::uint32_t ns, double az) {
  RosBytes message;
  message.header(s, ns).zeros(32 + 72);
  message.add(0.1).add(-0.2).add(0.3).zeros(72);
  message.add(0.0).add(0.5).add(az).zeros(72);
  return message.bytes();
}

inline std::vector<std::byte> livox_message(std::uint32_t s, std::uint32_t points) {
  RosBytes message;
  message.header(s, 5).add<std::uint64_t>(0).add(points).add<std::uint32_t>(0).add(points);
  for (std::uint32_t i = 0; i < points; ++i) {
    message.add(i * 10'000'000U).add(1.0F + static_cast<float>(i)).add(2.0F).add(3.0F);
    message.add<std::uint8_t>(77).add<std::uint8_t>(0x10).add(static_cast<std::uint8_t>(i % 6));
  }
  return message.bytes();
}

inline std::vector<std::byte> velodyne_message(std::uint32_t s,
                                               std::uint32_t packets,
                                               std::uint8_t model) {
  RosBytes message;
  message.header(s, 0).add(packets);
  for (std::uint32_t i = 0; i < packets; ++i) {
    message.add(s).add(i * 1'000'000U).zeros(1204).add<std::uint8_t>(0x37).add(model);
  }
  return message.bytes();
}

/// PointCloud2 with x, y, z, intensity, ring, time as velodyne_pointcloud writes it: 22 bytes a
/// point.
inline std::vector<std::byte> cloud_message(std::uint32_t s, std::uint32_t points) {
  RosBytes message;
  message.header(s, 0).add<std::uint32_t>(1).add(points).add<std::uint32_t>(6);
  const auto field = [&message](const char* name, std::uint32_t offset, std::uint8_t type) {
    message.text(name).add(offset).add(type).add<std::uint32_t>(1);
  };
  field("x", 0, 7);
  field("y", 4, 7);
  field("z", 8, 7);
  field("intensity", 12, 7);
  field("ring", 16, 4);
  field("time", 18, 7);
  message.add<std::uint8_t>(0).add<std::uint32_t>(22).add(22 * points).add(22 * points);
  for (std::uint32_t i = 0; i < points; ++i) {
    message.add(1.0F + static_cast<float>(i)).add(2.0F).add(3.0F).add(50.0F);
    message.add(static_cast<std::uint16_t>(i % 16)).add(-0.09F + 0.01F * static_cast<float>(i));
  }
  return message.add<std::uint8_t>(1).bytes();
}

}  // namespace slamd::importing
