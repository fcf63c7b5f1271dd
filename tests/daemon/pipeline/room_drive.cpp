#include "tests/daemon/pipeline/room_drive.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"
#include "tests/world/room.hpp"

namespace slamd::pipeline {

namespace {

constexpr double kSequence_s = 55.296e-6;  // sixteen lasers, one after the other, and a recharge
constexpr double kLaser_s = 2.304e-6;
constexpr double kPacket_s = 24 * kSequence_s;
constexpr double kAcceleration_mps2 = 0.5;
const Eigen::Vector3d kLidarInBase_m(0.12, 0.0, 0.26);

Stamp stamp_at(double t_s) { return Stamp(std::chrono::seconds(1000) + Duration(std::llround(1e9 * t_s))); }

double azimuth_rad(double t_s) { return 2.0 * M_PI * 10.0 * t_s; }

double distance_driven_m(double t_s, double rest_s) {
  const double moving_s = std::max(0.0, t_s - rest_s);
  return 0.5 * kAcceleration_mps2 * moving_s * moving_s;
}

std::vector<std::byte> data_packet(const world::Room& room, double begin_s, double rest_s, std::mt19937_64& engine) {
  std::vector<std::byte> bytes(1206);
  std::normal_distribution<double> noise_m(0.0, 0.01);
  for (std::size_t sequence = 0; sequence < 24; ++sequence) {
    const double sequence_s = begin_s + kSequence_s * static_cast<double>(sequence);
    const std::size_t block = 100 * (sequence / 2);
    if (sequence % 2 == 0) {
      const double centidegrees = 100.0 * azimuth_rad(sequence_s) / kDegree;
      store_le<std::uint16_t>(bytes, block, 0xEEFF);
      store_le(bytes, block + 2, static_cast<std::uint16_t>(std::llround(centidegrees) % 36000));
    }
    for (std::size_t laser = 0; laser < 16; ++laser) {
      const double t_s = sequence_s + kLaser_s * static_cast<double>(laser);
      const double alpha = azimuth_rad(t_s);
      const double omega = (static_cast<double>(laser) - (laser % 2 == 0 ? 15.0 : 0.0)) * kDegree;
      const Eigen::Vector3d ray(std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega));
      const Eigen::Vector3d eye = kLidarInBase_m + Eigen::Vector3d(distance_driven_m(t_s, rest_s), 0.0, 0.0);
      const double range_m = room.cast(eye, ray) + noise_m(engine);
      const std::size_t at = block + 4 + 3 * (16 * (sequence % 2) + laser);
      store_le(bytes, at, static_cast<std::uint16_t>(std::lround(range_m / 0.002)));
      bytes[at + 2] = std::byte{50};
    }
  }
  store_le(bytes, 1200, static_cast<std::uint32_t>(std::llround(1e6 * (60.0 + begin_s))));  // since the hour
  bytes[1204] = std::byte{0x37};  // the strongest return
  bytes[1205] = std::byte{0x22};  // of a VLP-16
  return bytes;
}

}  // namespace

RoomDrive drive_in_room(double rest_s, double length_s) {
  RoomDrive drive;
  std::mt19937_64 engine(4);
  const world::Room room;
  for (double begin_s = 0.0; begin_s + kPacket_s < length_s; begin_s += kPacket_s) {
    drive.packets.push_back({stamp_at(begin_s + kPacket_s + 1e-4), data_packet(room, begin_s, rest_s, engine)});
  }
  std::normal_distribution<double> noise(0.0, 1.0);
  const auto about = [&](double std) -> Eigen::Vector3d { return std * Eigen::Vector3d(noise(engine), noise(engine), noise(engine)); };
  for (int i = 0; 0.005 * i < length_s; ++i) {
    sensor::ImuSample sample;
    sample.stamp = stamp_at(0.005 * i);
    sample.angular_rate_radps = about(0.002);
    sample.specific_force_mps2 =
        about(0.02) + Eigen::Vector3d(0.005 * i > rest_s ? kAcceleration_mps2 : 0.0, 0.0, kStandardGravity_mps2);
    drive.samples.push_back(sample);
  }
  return drive;
}

}  // namespace slamd::pipeline
