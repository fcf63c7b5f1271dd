#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/livox/livox_decoder.hpp"
#include "drivers/livox/sdk2_decoder.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "tools/simulate/packet_stream.hpp"

namespace slamd::simulate {

/// The number of the shot that a point came from, as the simulated LiDAR counts; VLP-16, Avia and Mid-360 only.
inline std::uint64_t shot_of(const Scene& scene, std::uint64_t index, const sensor::Point& point) {
  const double offset_s = 1e-9 * point.offset_ns;
  if (scene.spinning() == nullptr) {
    const double rate_hz = scene.avia() != nullptr ? LivoxLidar::kFirings_hz : Mid360Lidar::kFirings_hz;
    return index * scene.lidar().shots() + static_cast<std::uint64_t>(std::lround(offset_s * rate_hz));
  }
  const std::uint64_t laser = point.line < 8 ? 2U * point.line : 2U * (point.line - 8U) + 1U;
  return index * scene.lidar().shots() + 16 * static_cast<std::uint64_t>(offset_s / 55.296e-6) + laser;
}

/// Reads every `every`-th point packet of a drive with the project's decoders; calls use(point, seconds since its
/// start, number of its shot).
template <typename Use>
void decode_points(const Scene& scene, std::uint64_t every, Use&& use) {
  velodyne::Decoder velodyne({std::nullopt, false});
  livox::LivoxDecoder livox{livox::LivoxConfig{}};
  livox::Sdk2Decoder sdk2{livox::Sdk2Config{}};
  livox::ImuReading imu;
  sensor::PointBlock block;
  for (std::uint64_t index = 0; index < scene.packets(); index += every) {
    const SentPacket packet = scene.lidar().packet(index);
    const bool good = scene.spinning() != nullptr
                          ? velodyne.decode(packet.payload, Stamp{}, block) == velodyne::DecodeResult::kOk
                      : scene.avia() != nullptr
                          ? livox.decode(packet.payload, Stamp{}, block, imu) == livox::DecodeResult::kPoints
                          : sdk2.decode(packet.payload, Stamp{}, block, imu) == livox::DecodeResult::kPoints;
    ASSERT_TRUE(good) << "packet " << index;
    const double begin_s = static_cast<double>(index) * scene.lidar().packet_s();
    for (const sensor::Point& point : block.points) {
      use(point, begin_s + 1e-9 * point.offset_ns, shot_of(scene, index, point));
    }
  }
}

/// Median and standard deviation of a list, the latter from its middle two thirds.
struct Spread {
  double median = 0.0;
  double sigma = 0.0;
  std::size_t count = 0;
};

inline Spread spread_of(std::vector<double> values) {
  if (values.empty()) {
    return {};
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {at(0.5), 0.5 * (at(0.8413) - at(0.1587)), values.size()};
}

}  // namespace slamd::simulate
