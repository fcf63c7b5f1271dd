#include "tools/simulate/spinning_lidar.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"
#include "tools/simulate/nmea.hpp"

namespace slamd::simulate {

namespace {

constexpr std::size_t kDataBytes = 1206;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kPositionBytes = 512;
constexpr std::uint32_t kAddress = 0xC0A801C9;  // 192.168.1.201

/// Microseconds since the top of the hour.
std::uint32_t stamp_us(double hour_s) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(1e6 * hour_s)) % 3'600'000'000ULL);
}

}  // namespace

SpinningLidar::SpinningLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar,
                             const RangeErrors& errors, std::uint64_t seed, const SpinningSettings& settings)
    : model_(model_of(settings.kind)),
      settings_(settings),
      motion_(motion),
      T_base_lidar_(T_base_lidar),
      noise_(seed, 40),
      beam_(world, errors, noise_),
      phase_deg_(noise_.uniform(1, 0.0, 360.0)) {
  for (std::uint64_t i = 0; i < 32; ++i) {
    beam_bias_m_[i] = errors.beam_bias_m * noise_.normal(100 + i);
  }
}

double SpinningLidar::azimuth_deg(double t_s) const {
  // Ten turns a second; the motor's control loop lets it breathe by ±0.3 °.
  return phase_deg_ + 3600.0 * t_s + 0.3 * std::sin(2.0 * M_PI * 0.7 * t_s + phase_deg_);
}

Eigen::Vector3d SpinningLidar::direction(double t_s, std::size_t laser) const {
  const double alpha = (azimuth_deg(t_s) - model_.azimuth_offset_deg[laser]) * kDegree;
  const double omega = model_.elevation_deg[laser] * kDegree;
  return {std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega)};
}

Eigen::Vector3d SpinningLidar::beam(double t_s, std::uint64_t shot) const {
  const auto lasers = static_cast<std::uint64_t>(model_.lasers);
  return direction(t_s + model_.sequence_s * static_cast<double>(shot / lasers), shot % lasers);
}

void SpinningLidar::store(std::span<std::byte> bytes, std::size_t at, const Echo& echo) const {
  store_le(bytes, at, static_cast<std::uint16_t>(std::clamp(std::lround(echo.range_m / model_.unit_m), 1L, 65535L)));
  store_le(bytes, at + 2,
           static_cast<std::uint8_t>(std::clamp(100.0 * static_cast<double>(echo.reflectivity), 1.0, 255.0)));
}

void SpinningLidar::shoot_sequence(std::uint64_t index, int sequence, std::span<std::byte> bytes) const {
  const double sequence_s = static_cast<double>(index) * packet_s() + model_.sequence_s * sequence;
  const ShortMotion motion(motion_, sequence_s);
  const int firing = sequence % model_.sequences_per_block();
  const int pair = sequence / model_.sequences_per_block();
  const std::size_t block = static_cast<std::size_t>(settings_.dual ? 2 * pair : pair) * kBlockBytes;
  for (int laser = 0; laser < model_.lasers; ++laser) {
    const auto id = static_cast<std::size_t>(laser);
    const double after_s = model_.laser_s * (laser / model_.group);
    const Eigen::Vector3d d_lidar = direction(sequence_s + after_s, id);
    const geometry::Se3 T_world_lidar = motion.pose_after(after_s) * T_base_lidar_;
    const std::uint64_t shot = index * shots() + static_cast<std::uint64_t>(sequence * model_.lasers + laser);
    const Echoes echoes = beam_.shoot(T_world_lidar.translation(), T_world_lidar.rotation() * d_lidar,
                                      sequence_s + after_s, shot, beam_bias_m_[id]);
    if (echoes.count == 0) {
      continue;  // sent as zeros
    }
    const std::size_t at = block + 4 + 3 * static_cast<std::size_t>(model_.lasers * firing + laser);
    const Echo* strongest = echoes.strongest();
    if (!settings_.dual) {
      store(bytes, at, *strongest);
      continue;
    }
    // The last return, and the strongest; where that is the last one, the second strongest.
    const Echo& last = echoes.echo[static_cast<std::size_t>(echoes.count) - 1];
    if (strongest == &last) {
      Echoes others = echoes;
      --others.count;
      strongest = others.count > 0 ? others.strongest() : nullptr;
      store(bytes, at + kBlockBytes, strongest != nullptr ? *strongest : last);
    } else {
      store(bytes, at + kBlockBytes, *strongest);
    }
    store(bytes, at, last);
  }
}

SentPacket SpinningLidar::data_packet(std::uint64_t index, double hour_offset_s) const {
  SentPacket packet;
  packet.payload.resize(kDataBytes);
  packet.source_address = kAddress;
  packet.source_port = packet.destination_port = 2368;
  const double begin_s = static_cast<double>(index) * packet_s();
  const std::span<std::byte> bytes(packet.payload);
  for (std::size_t block = 0; block < 12; ++block) {
    const auto pair = static_cast<int>(settings_.dual ? block / 2 : block);
    const double block_s = begin_s + model_.sequence_s * model_.sequences_per_block() * pair;
    store_le<std::uint16_t>(bytes, block * kBlockBytes, 0xEEFF);
    store_le(
        bytes, block * kBlockBytes + 2,
        static_cast<std::uint16_t>(static_cast<std::uint64_t>(std::llround(100.0 * azimuth_deg(block_s))) % 36000));
  }
  for (int sequence = 0; sequence < sequences(); ++sequence) {
    shoot_sequence(index, sequence, bytes);
  }
  store_le(bytes, 1200, stamp_us(hour_offset_s + begin_s));
  bytes[1204] = std::byte{settings_.dual ? std::uint8_t{0x39} : std::uint8_t{0x37}};
  bytes[1205] = std::byte{model_.product};
  // The network: a hundred microseconds, and a tail.
  packet.sent_s = begin_s + packet_s() + 1e-4 - 3e-5 * std::log(1.0 - noise_.uniform(index * 16 + 7));
  return packet;
}

SentPacket SpinningLidar::position_packet(std::uint64_t index) const {
  SentPacket packet;
  const double t_s = static_cast<double>(index) * packet_s();
  packet.payload.resize(kPositionBytes);
  packet.source_address = kAddress;
  packet.source_port = packet.destination_port = 8308;
  packet.sent_s = t_s + 1e-4;
  const std::span<std::byte> bytes(packet.payload);
  store_le(bytes, 0xC6, stamp_us(settings_.hour_offset_s + t_s));
  bytes[0xCA] = std::byte{2};  // PPS locked
  // The receiver says once a second where it is.
  const double second = std::floor(t_s);
  const MotionState state = motion_.at(second);
  const Eigen::Vector3d& v = state.velocity_mps;
  const double course_deg = std::fmod(std::atan2(v.x(), v.y()) / kDegree + 360.0, 360.0);
  const std::string sentence =
      rmc_sentence(settings_.unix_s + static_cast<std::int64_t>(second), geodetic_of(state.T_world_base.translation()),
                   v.head<2>().norm(), course_deg);
  for (std::size_t i = 0; i < sentence.size(); ++i) {
    bytes[0xCE + i] = static_cast<std::byte>(sentence[i]);
  }
  return packet;
}

}  // namespace slamd::simulate
