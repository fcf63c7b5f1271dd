#include "tools/simulate/mid360_lidar.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"

namespace slamd::simulate {

namespace {

constexpr std::size_t kHeaderBytes = 36;
constexpr std::size_t kPointBytes = 14;
constexpr std::size_t kImuBytes = 24;
constexpr double kLowest_deg = -7.0;
constexpr double kHighest_deg = 52.0;
constexpr double kTurns_hz = 10.37;
constexpr double kSwings_hz = 1127.3;

SentPacket packet_with_header(std::size_t bytes, std::uint8_t type, std::uint16_t points, std::uint16_t interval,
                              std::uint64_t number, double t_s) {
  SentPacket packet;
  packet.source_address = 0xC0A80170;  // 192.168.1.112
  packet.source_port = type == 0 ? 56400 : 56300;
  packet.destination_port = type == 0 ? Mid360Lidar::kImuPort : Mid360Lidar::kPointPort;
  packet.payload.resize(kHeaderBytes + bytes);
  const std::span<std::byte> payload(packet.payload);
  store_le(payload, 1, static_cast<std::uint16_t>(payload.size()));
  store_le(payload, 3, interval);
  store_le(payload, 5, points);
  store_le(payload, 7, static_cast<std::uint16_t>(number));
  payload[10] = std::byte{type};
  store_le(payload, 28, Mid360Lidar::kPowerUp_ns + static_cast<std::uint64_t>(std::llround(1e9 * t_s)));
  return packet;
}

void seal(SentPacket& packet) {
  const std::span<std::byte> payload(packet.payload);
  store_le(payload, 24, crc32_of(payload.subspan(28)));
}

}  // namespace

std::uint32_t crc32_of(std::span<const std::byte> bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> entries{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) {
        value = value & 1U ? value >> 1 ^ 0xEDB88320U : value >> 1;
      }
      entries[i] = value;
    }
    return entries;
  }();
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    crc = crc >> 8 ^ table[(crc ^ static_cast<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~crc;
}

Mid360Lidar::Mid360Lidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar,
                         const RangeErrors& errors, std::uint64_t seed)
    : motion_(motion), T_base_lidar_(T_base_lidar), noise_(seed, 55), beam_(world, errors, noise_) {}

Eigen::Vector3d Mid360Lidar::direction(double t_s, int line) const {
  const double azimuth = 2.0 * M_PI * (kTurns_hz * t_s + 0.25 * line);
  const double swing = std::abs(std::remainder(kSwings_hz * t_s + 0.11 * line, 1.0)) * 2.0;  // a triangle from 0 to 1
  const double elevation = (kLowest_deg + (kHighest_deg - kLowest_deg) * swing) * M_PI / 180.0;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

SentPacket Mid360Lidar::packet(std::uint64_t index) const {
  const double begin_s = static_cast<double>(index) * packet_s();
  SentPacket packet = packet_with_header(kFirings * kPointBytes, 1, kFirings, 4750, index, begin_s);
  packet.sent_s = begin_s + packet_s() + 1e-4 - 2e-5 * std::log(1.0 - noise_.uniform(index * 16 + 7));
  const std::span<std::byte> bytes(packet.payload);
  ShortMotion motion(motion_, begin_s);
  for (std::uint64_t firing = 0; firing < kFirings; ++firing) {
    const double t_s = begin_s + static_cast<double>(firing) / kFirings_hz;
    const std::uint64_t in_motion = firing % 12;
    if (in_motion == 0) {
      motion = ShortMotion(motion_, t_s);
    }
    const Eigen::Vector3d d_lidar = direction(t_s, static_cast<int>(firing % 4));
    const geometry::Se3 T_world_lidar = motion.pose_after(static_cast<double>(in_motion) / kFirings_hz) * T_base_lidar_;
    const Echoes echoes = beam_.shoot(T_world_lidar.translation(), T_world_lidar.rotation() * d_lidar, t_s,
                                      index * kFirings + firing, 0.0);
    if (echoes.count == 0) {
      continue;
    }
    const Echo& echo = *echoes.strongest();
    const std::size_t at = kHeaderBytes + kPointBytes * static_cast<std::size_t>(firing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      store_le(bytes, at + 4 * axis,
               static_cast<std::int32_t>(std::lround(1e3 * echo.range_m * d_lidar[static_cast<int>(axis)])));
    }
    store_le(bytes, at + 12,
             static_cast<std::uint8_t>(std::clamp(150.0 * static_cast<double>(echo.reflectivity), 1.0, 150.0)));
    store_le(bytes, at + 13, static_cast<std::uint8_t>((echo.air ? 2U << 2 : 0U) | (echo.mixed ? 2U : 0U)));
  }
  seal(packet);
  return packet;
}

SentPacket Mid360Lidar::imu_packet(double t_s, std::uint64_t index, const InertialReading& reading) const {
  SentPacket packet = packet_with_header(kImuBytes, 0, 1, 0, index, t_s);
  packet.sent_s = t_s + 1.2e-4;
  const std::span<std::byte> bytes(packet.payload);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    store_le(bytes, kHeaderBytes + 4 * axis, static_cast<float>(reading.rate_radps[i]));
    store_le(bytes, kHeaderBytes + 12 + 4 * axis, static_cast<float>(reading.force_mps2[i] / kStandardGravity_mps2));
  }
  seal(packet);
  return packet;
}

}  // namespace slamd::simulate
