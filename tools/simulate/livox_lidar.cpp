#include "tools/simulate/livox_lidar.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"

namespace slamd::simulate {

namespace {

constexpr std::size_t kHeaderBytes = 18;
constexpr std::size_t kPointBytes = 14;
constexpr int kFiringsAMotion = 12;  // 50 µs

/// Return number, what the device thinks of its intensity, and of its place.
std::uint8_t tag_of(const Echo& echo, std::size_t number) {
  const unsigned air = echo.air ? 1U : 0U;      // high-confidence noise
  const unsigned drag = echo.mixed ? 2U : 0U;   // moderate-confidence noise
  return static_cast<std::uint8_t>((number + 1) << 4 | air << 2 | drag);
}

/// Reflectivity and tag.
void store_rest(std::span<std::byte> bytes, std::size_t at, const Echo& echo, std::size_t number) {
  store_le(bytes, at,
           static_cast<std::uint8_t>(std::clamp(150.0 * static_cast<double>(echo.reflectivity), 1.0, 150.0)));
  store_le(bytes, at + 1, tag_of(echo, number));
}

void store_cartesian(std::span<std::byte> bytes, const Echo& echo, const Eigen::Vector3d& d_lidar, std::size_t number) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    store_le(bytes, 4 * axis,
             static_cast<std::int32_t>(std::lround(1e3 * echo.range_m * d_lidar[static_cast<int>(axis)])));
  }
  store_rest(bytes, 12, echo, number);
}

/// From +z, and from +x towards +y.
void store_angles(std::span<std::byte> bytes, std::size_t at, const Eigen::Vector3d& d_lidar) {
  constexpr double kCentidegree = M_PI / 18000.0;
  const double zenith = std::acos(std::clamp(d_lidar.z(), -1.0, 1.0)) / kCentidegree;
  const double azimuth = std::atan2(d_lidar.y(), d_lidar.x()) / kCentidegree;
  store_le(bytes, at, static_cast<std::uint16_t>(std::lround(zenith)));
  store_le(bytes, at + 2, static_cast<std::uint16_t>(std::lround(azimuth < 0.0 ? azimuth + 36000.0 : azimuth)));
}

void store_depth(std::span<std::byte> bytes, std::size_t at, const Echo& echo) {
  store_le(bytes, at, static_cast<std::uint32_t>(std::max(1L, std::lround(1e3 * echo.range_m))));
}

/// The prisms' phases at time 0. Those of the repetitive pattern are a moment of a level band.
std::array<double, 3> phases_of(RisleyPattern pattern, const Noise& noise) {
  const double first = noise.uniform(1, 0.0, 2.0 * M_PI);
  if (pattern == RisleyPattern::kRepetitive) {
    return {-first, first, 3.0 * first};
  }
  return {first, noise.uniform(2, 0.0, 2.0 * M_PI), noise.uniform(3, 0.0, 2.0 * M_PI)};
}

}  // namespace

LivoxLidar::LivoxLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar,
                       const RangeErrors& errors, std::uint64_t seed, const LivoxSettings& settings)
    : motion_(motion),
      T_base_lidar_(T_base_lidar),
      noise_(seed, 50),
      beam_(world, errors, noise_),
      settings_(settings),
      pattern_(phases_of(settings.pattern, noise_), settings.pattern) {
  for (std::uint64_t i = 0; i < 6; ++i) {
    line_bias_m_[i] = errors.beam_bias_m * noise_.normal(100 + i);
  }
}

SentPacket LivoxLidar::packet_with_header(double t_s, std::uint8_t data_type, std::size_t bytes) const {
  SentPacket packet;
  packet.source_address = 0xC0A80164;  // 192.168.1.100
  packet.source_port = 65000;
  packet.destination_port = kPort;
  packet.payload.resize(kHeaderBytes + bytes);
  packet.payload[0] = std::byte{5};
  packet.payload[1] = std::byte{1};
  packet.payload[2] = std::byte{1};
  packet.payload[9] = std::byte{data_type};
  store_le<std::uint64_t>(packet.payload, 10, kPowerUp_ns + static_cast<std::uint64_t>(std::llround(1e9 * t_s)));
  return packet;
}

std::uint8_t LivoxLidar::data_type() const {
  const std::uint8_t cartesian = echoes() == 1 ? 2 : echoes() == 2 ? 4 : 7;
  return settings_.spherical ? cartesian + 1 : cartesian;
}

std::size_t LivoxLidar::firing_bytes() const {
  if (!settings_.spherical) {
    return kPointBytes * echoes();
  }
  return 4 + 6 * echoes();
}

/// A lone spherical return has its depth in front of the angles; several have the angles in front of all.
void LivoxLidar::store(std::span<std::byte> firing, const Echoes& found, const Eigen::Vector3d& d_lidar) const {
  if (settings_.spherical) {
    store_angles(firing, echoes() == 1 ? 4 : 0, d_lidar);
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(echoes(), static_cast<std::size_t>(found.count)); ++i) {
    const Echo& echo = settings_.returns == LivoxReturns::kStrongest ? *found.strongest() : found.echo[i];
    if (!settings_.spherical) {
      store_cartesian(firing.subspan(kPointBytes * i), echo, d_lidar, i);
    } else if (echoes() == 1) {
      store_depth(firing, 0, echo);
      store_rest(firing, 8, echo, i);
    } else {
      store_depth(firing, 4 + 6 * i, echo);
      store_rest(firing, 8 + 6 * i, echo, i);
    }
  }
}

SentPacket LivoxLidar::point_packet(std::uint64_t index) const {
  const double begin_s = static_cast<double>(index) * packet_s();
  SentPacket packet = packet_with_header(begin_s, data_type(), shots() * firing_bytes());
  packet.sent_s = begin_s + packet_s() + 1e-4 - 2e-5 * std::log(1.0 - noise_.uniform(index * 16 + 7));
  const std::span<std::byte> bytes(packet.payload);
  ShortMotion motion(motion_, begin_s);
  int motion_begin = 0;
  for (int firing = 0; firing < static_cast<int>(shots()); ++firing) {
    const double t_s = begin_s + firing / kFirings_hz;
    if (firing - motion_begin == kFiringsAMotion) {
      motion = ShortMotion(motion_, t_s);
      motion_begin = firing;
    }
    const int line = firing % 6;
    const Eigen::Vector3d d_lidar = pattern_.direction(t_s, line);
    const geometry::Se3 T_world_lidar = motion.pose_after((firing - motion_begin) / kFirings_hz) * T_base_lidar_;
    const std::uint64_t shot = index * shots() + static_cast<std::uint64_t>(firing);
    const Echoes found =
        beam_.shoot(T_world_lidar.translation(), T_world_lidar.rotation() * d_lidar, t_s, shot, line_bias_m_[line]);
    store(bytes.subspan(kHeaderBytes + firing_bytes() * static_cast<std::size_t>(firing), firing_bytes()), found,
          d_lidar);
  }
  return packet;
}

SentPacket LivoxLidar::imu_packet(double t_s, const InertialReading& reading) const {
  SentPacket packet = packet_with_header(t_s, 6, 24);
  packet.sent_s = t_s + 1.2e-4;
  const std::span<std::byte> bytes(packet.payload);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<int>(axis);
    store_le(bytes, kHeaderBytes + 4 * axis, static_cast<float>(reading.rate_radps[i]));
    store_le(bytes, kHeaderBytes + 12 + 4 * axis, static_cast<float>(reading.force_mps2[i] / kStandardGravity_mps2));
  }
  return packet;
}

}  // namespace slamd::simulate
