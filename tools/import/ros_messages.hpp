#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/stamp.hpp"
#include "core/sensor/imu_sample.hpp"
#include "drivers/clouds/raw_cloud.hpp"

namespace slamd::importing {

/// Serialized ROS 1 messages, taken apart by hand: little-endian, strings and arrays with a 32-bit
/// length in front. Any bytes may be given; a parser that meets an end too early, or a length that
/// the message cannot hold, returns nothing (or false).

/// sensor_msgs/Imu. Frames: as the driver made it, mostly imu.
std::optional<sensor::ImuSample> parse_imu(std::span<const std::byte> message);

/// A cloud and the stamp of its header. The columns refer to the message's bytes.
struct CloudMessage {
  Stamp stamp{};
  clouds::RawCloud cloud;
};

/// sensor_msgs/PointCloud2: the fields as they are there.
std::optional<CloudMessage> parse_point_cloud2(std::span<const std::byte> message);

/// livox_ros_driver/CustomMsg and livox_ros_driver2/CustomMsg: offset_time, x, y, z, reflectivity,
/// tag, line.
std::optional<CloudMessage> parse_livox_custom(std::span<const std::byte> message);

/// velodyne_msgs/VelodyneScan: gives each packet's stamp and its 1,206 bytes to `packet`. Returns
/// false, without having given any, when the message is malformed.
bool parse_velodyne_scan(
    std::span<const std::byte> message,
    const std::function<void(Stamp stamp, std::span<const std::byte> payload)>& packet);

}  // namespace slamd::importing
