#pragma once

#include <cstddef>
#include <vector>

#include "core/sensor/imu_sample.hpp"

namespace slamd::pipeline {

/// A VLP-16's data packet as it comes from the network.
struct LidarPacket {
  Stamp received{};
  std::vector<std::byte> payload;  // 1206 bytes
};

/// A few seconds of a vehicle in a world::Room: it rests, then drives ahead. Noise from a fixed seed.
struct RoomDrive {
  std::vector<LidarPacket> packets;       // 754 a second
  std::vector<sensor::ImuSample> samples;  // 200 a second, in base's axes
};

/// Returns the drive as the sensors saw it. The LiDAR looks along base's axes from (0.12, 0, 0.26) m.
RoomDrive drive_in_room(double rest_s, double length_s);

}  // namespace slamd::pipeline
