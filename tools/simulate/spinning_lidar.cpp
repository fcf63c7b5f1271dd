#include "tools/simulate/spinning_lidar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>

#include "core/base/bytes.hpp"

namespace slamd::simulate {

namespace {

constexpr double kLaser_s = 2.304e-6;
constexpr double kSequence_s = 55.296e-6;
constexpr int kElevations_deg[16] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr double kUnit_m = 0.002;
constexpr std::size_t kDataBytes = 1206;
constexpr std::size_t kPositionBytes = 512;

}  // namespace

SpinningLidar::SpinningLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar,
                             const RangeErrors& errors, std::uint64_t seed)
    : world_(world),
      motion_(motion),
      T_base_lidar_(T_base_lidar),
      errors_(errors),
      noise_(seed, 40),
      phase_deg_(noise_.uniform(1, 0.0, 360.0)) {
  for (std::uint64_t i = 0; i < 16; ++i) {
    beam_bias_m_[i] = errors_.beam_bias_m * noise_.normal(100 + i);
  }
}

double SpinningLidar::azimuth_deg(double t_s) const {
  // Ten turns a second; the motor's control loop lets it breathe by ±0.3 °.
  return phase_deg_ + 3600.0 * t_s + 0.3 * std::sin(2.0 * M_PI * 0.7 * t_s + phase_deg_);
}

std::uint16_t SpinningLidar::range_units(const geometry::Se3& T_world_lidar, double azimuth_deg, int laser,
                                         std::uint64_t ray, std::uint8_t& reflectivity) const {
  const double alpha = azimuth_deg * M_PI / 180.0;
  const double omega = kElevations_deg[laser] * M_PI / 180.0;
  const Eigen::Vector3d d_lidar(std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega));
  Hit hit;
  reflectivity = 0;
  if (!world_.cast(T_world_lidar.translation(), T_world_lidar.rotation() * d_lidar, errors_.max_range_m, ray, hit) ||
      hit.range_m < errors_.min_range_m) {
    return 0;
  }
  // What comes back falls with the square of the range; grazing and dark surfaces vanish first.
  const double signal = static_cast<double>(hit.reflectivity) * hit.cos_incidence / (hit.range_m * hit.range_m);
  const double chance = std::clamp(signal / 1.2e-5, 0.0, 1.0);
  if (noise_.uniform(8 * ray + 5) > chance) {
    return 0;
  }
  const double range = hit.range_m + beam_bias_m_[laser] + errors_.noise_m * noise_.normal(4 * ray + 1);
  reflectivity = static_cast<std::uint8_t>(std::clamp(100.0 * static_cast<double>(hit.reflectivity), 1.0, 255.0));
  return static_cast<std::uint16_t>(std::clamp(std::lround(range / kUnit_m), 1L, 65535L));
}

SentPacket SpinningLidar::data_packet(std::uint64_t index, double hour_offset_s) const {
  SentPacket packet;
  packet.payload.resize(kDataBytes);
  packet.destination_port = 2368;
  const double begin_s = static_cast<double>(index) * kPacket_s;
  const std::span<std::byte> bytes(packet.payload);
  for (int sequence = 0; sequence < 24; ++sequence) {
    const double sequence_s = begin_s + kSequence_s * sequence;
    const std::size_t block = static_cast<std::size_t>(sequence / 2) * 100;
    if (sequence % 2 == 0) {
      store_le<std::uint16_t>(bytes, block, 0xEEFF);
      const auto cdeg = static_cast<std::uint64_t>(std::llround(100.0 * azimuth_deg(sequence_s))) % 36000;
      store_le(bytes, block + 2, static_cast<std::uint16_t>(cdeg));
    }
    for (int laser = 0; laser < 16; ++laser) {
      const double t_s = sequence_s + kLaser_s * laser;
      const geometry::Se3 T_world_lidar = motion_.pose_at(t_s) * T_base_lidar_;
      const std::uint64_t ray = (index * 24 + static_cast<std::uint64_t>(sequence)) * 16 + static_cast<std::uint64_t>(laser);
      std::uint8_t reflectivity = 0;
      const std::uint16_t range = range_units(T_world_lidar, azimuth_deg(t_s), laser, ray, reflectivity);
      const std::size_t at = block + 4 + 3 * static_cast<std::size_t>(16 * (sequence % 2) + laser);
      store_le(bytes, at, range);
      store_le(bytes, at + 2, reflectivity);
    }
  }
  const auto stamp_us = static_cast<std::uint64_t>(std::llround(1e6 * (hour_offset_s + begin_s))) % 3'600'000'000ULL;
  store_le(bytes, 1200, static_cast<std::uint32_t>(stamp_us));
  bytes[1204] = std::byte{0x37};
  bytes[1205] = std::byte{0x22};
  // The network: a hundred microseconds, and a tail.
  packet.sent_s = begin_s + kPacket_s + 1e-4 - 3e-5 * std::log(1.0 - noise_.uniform(index * 16 + 7));
  return packet;
}

SentPacket SpinningLidar::position_packet(double t_s, double hour_offset_s, std::int64_t unix_s) const {
  SentPacket packet;
  packet.payload.resize(kPositionBytes);
  packet.destination_port = 8308;
  packet.sent_s = t_s + 1e-4;
  const std::span<std::byte> bytes(packet.payload);
  const auto stamp_us = static_cast<std::uint64_t>(std::llround(1e6 * (hour_offset_s + t_s))) % 3'600'000'000ULL;
  store_le(bytes, 0xC6, static_cast<std::uint32_t>(stamp_us));
  bytes[0xCA] = std::byte{2};  // PPS locked
  const std::time_t now = unix_s + static_cast<std::int64_t>(t_s);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[96];
  std::snprintf(text, sizeof text, "GPRMC,%02d%02d%02d,A,5224.000,N,01331.000,E,000.0,000.0,%02d%02d%02d,003.1,W",
                utc.tm_hour, utc.tm_min, utc.tm_sec, utc.tm_mday, utc.tm_mon + 1, utc.tm_year % 100);
  unsigned sum = 0;
  for (const char* c = text; *c != '\0'; ++c) {
    sum ^= static_cast<unsigned char>(*c);
  }
  char sentence[112];
  const int length = std::snprintf(sentence, sizeof sentence, "$%s*%02X\r\n", text, sum);
  for (int i = 0; i < length; ++i) {
    bytes[0xCE + static_cast<std::size_t>(i)] = static_cast<std::byte>(sentence[i]);
  }
  return packet;
}

}  // namespace slamd::simulate
