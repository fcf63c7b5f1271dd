#include "tools/simulate/livox_lidar.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/bytes.hpp"

namespace slamd::simulate {

namespace {

constexpr std::size_t kHeaderBytes = 18;
constexpr std::size_t kPointBytes = 14;
constexpr int kFirings = 96;
constexpr double kFiringRate_hz = 240'000.0;
constexpr double kGravity_mps2 = 9.80665;

}  // namespace

LivoxLidar::LivoxLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar,
                       const RangeErrors& errors, std::uint64_t seed)
    : world_(world),
      motion_(motion),
      T_base_lidar_(T_base_lidar),
      errors_(errors),
      noise_(seed, 50),
      pattern_({noise_.uniform(1, 0.0, 2.0 * M_PI), noise_.uniform(2, 0.0, 2.0 * M_PI), noise_.uniform(3, 0.0, 2.0 * M_PI)}) {
  for (std::uint64_t i = 0; i < 6; ++i) {
    line_bias_m_[i] = errors_.beam_bias_m * noise_.normal(100 + i);
  }
}

std::vector<std::byte> LivoxLidar::header(double t_s, std::uint8_t data_type, std::size_t bytes) const {
  std::vector<std::byte> payload(kHeaderBytes + bytes);
  payload[0] = std::byte{5};
  payload[1] = std::byte{1};
  payload[2] = std::byte{1};
  payload[9] = std::byte{data_type};
  store_le<std::uint64_t>(payload, 10, kPowerUp_ns + static_cast<std::uint64_t>(std::llround(1e9 * t_s)));
  return payload;
}

SentPacket LivoxLidar::point_packet(std::uint64_t index) const {
  SentPacket packet;
  const double begin_s = static_cast<double>(index) * kPacket_s;
  packet.payload = header(begin_s, 2, kFirings * kPointBytes);
  packet.destination_port = kPort;
  packet.sent_s = begin_s + kPacket_s + 1e-4 - 2e-5 * std::log(1.0 - noise_.uniform(index * 16 + 7));
  const std::span<std::byte> bytes(packet.payload);
  for (int firing = 0; firing < kFirings; ++firing) {
    const double t_s = begin_s + firing / kFiringRate_hz;
    const int line = firing % 6;
    const Eigen::Vector3d d_lidar = pattern_.direction(t_s, line);
    const geometry::Se3 T_world_lidar = motion_.pose_at(t_s) * T_base_lidar_;
    const std::uint64_t ray = index * kFirings + static_cast<std::uint64_t>(firing);
    Hit hit;
    if (!world_.cast(T_world_lidar.translation(), T_world_lidar.rotation() * d_lidar, errors_.max_range_m, ray, hit) ||
        hit.range_m < errors_.min_range_m) {
      continue;  // sent as zeros
    }
    const double signal = static_cast<double>(hit.reflectivity) * hit.cos_incidence / (hit.range_m * hit.range_m);
    if (noise_.uniform(8 * ray + 5) > std::clamp(signal / 3e-6, 0.0, 1.0)) {
      continue;
    }
    const double range = hit.range_m + line_bias_m_[line] + errors_.noise_m * noise_.normal(4 * ray + 1);
    const std::size_t at = kHeaderBytes + kPointBytes * static_cast<std::size_t>(firing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      store_le(bytes, at + 4 * axis, static_cast<std::int32_t>(std::lround(1e3 * range * d_lidar[static_cast<int>(axis)])));
    }
    store_le(bytes, at + 12, static_cast<std::uint8_t>(std::clamp(150.0 * static_cast<double>(hit.reflectivity), 1.0, 150.0)));
    store_le<std::uint8_t>(bytes, at + 13, 0x10);
  }
  return packet;
}

SentPacket LivoxLidar::imu_packet(double t_s, const InertialReading& reading) const {
  SentPacket packet;
  packet.payload = header(t_s, 6, 24);
  packet.destination_port = kPort;
  packet.sent_s = t_s + 1.2e-4;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    store_le(std::span<std::byte>(packet.payload), kHeaderBytes + 4 * axis, static_cast<float>(reading.rate_radps[i]));
    store_le(std::span<std::byte>(packet.payload), kHeaderBytes + 12 + 4 * axis,
             static_cast<float>(reading.force_mps2[i] / kGravity_mps2));
  }
  return packet;
}

}  // namespace slamd::simulate
