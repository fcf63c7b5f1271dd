#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/se3.hpp"
#include "tools/simulate/motion.hpp"
#include "tools/simulate/world.hpp"

namespace slamd::simulate {

/// How a LiDAR errs.
struct RangeErrors {
  double noise_m = 0.012;       // of each range
  double beam_bias_m = 0.005;   // of each laser, fixed
  double max_range_m = 100.0;
  double min_range_m = 0.4;
};

/// Bytes on the wire and when they leave the sensor's socket. Units: s since the start of the drive.
struct SentPacket {
  double sent_s = 0.0;
  std::uint16_t destination_port = 0;
  std::vector<std::byte> payload;
};

/// A VLP-16 in strongest-return mode: 600 rpm with a little jitter, each laser cast at its own firing time.
/// The bytes follow the protocol description; no code is shared with the decoder that will read them.
class SpinningLidar {
 public:
  SpinningLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar, const RangeErrors& errors,
                std::uint64_t seed);

  static constexpr double kPacket_s = 24 * 55.296e-6;

  /// Makes data packet number `index`; thread-safe, and the same whatever was made before.
  /// `hour_offset_s` is the sensor's time since the top of the hour at the start.
  SentPacket data_packet(std::uint64_t index, double hour_offset_s) const;

  /// Makes a position packet with a $GPRMC sentence. `unix_s` is the UTC time of the drive's start.
  SentPacket position_packet(double t_s, double hour_offset_s, std::int64_t unix_s) const;

 private:
  double azimuth_deg(double t_s) const;
  std::uint16_t range_units(const geometry::Se3& T_world_lidar, double azimuth_deg, int laser, std::uint64_t ray,
                            std::uint8_t& reflectivity) const;

  const World& world_;
  const Motion& motion_;
  geometry::Se3 T_base_lidar_;
  RangeErrors errors_;
  Noise noise_;
  double phase_deg_;
  double beam_bias_m_[16];
};

}  // namespace slamd::simulate
