#pragma once

#include <span>
#include <vector>

#include "core/geometry/se3.hpp"
#include "tools/simulate/beam.hpp"
#include "tools/simulate/motion.hpp"
#include "tools/simulate/sent_packet.hpp"
#include "tools/simulate/spinning_model.hpp"

namespace slamd::simulate {

/// What a Velodyne is set to.
struct SpinningSettings {
  SpinningKind kind = SpinningKind::kVlp16;
  bool dual = false;
  double hour_offset_s = 0.0;  // the sensor's time since the top of the hour, at the start of the drive
  std::int64_t unix_s = 0;     // UTC at the start
};

/// A Velodyne at 600 rpm with a little jitter, each laser cast at its own firing time.
/// The bytes follow the protocol description; no code is shared with the decoder that will read them.
class SpinningLidar : public PacketMaker {
 public:
  SpinningLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar, const RangeErrors& errors,
                std::uint64_t seed, const SpinningSettings& settings = {});

  SentPacket packet(std::uint64_t index) const override { return data_packet(index, settings_.hour_offset_s); }
  double packet_s() const override { return sequences() * model_.sequence_s; }
  std::uint64_t shots() const override { return static_cast<std::uint64_t>(sequences() * model_.lasers); }

  Eigen::Vector3d beam(double t_s, std::uint64_t shot) const override;

  /// Makes a point packet of a sensor whose clock said `hour_offset_s` past the hour at the start.
  SentPacket data_packet(std::uint64_t index, double hour_offset_s) const;

  /// Makes the position packet with a $GPRMC sentence that follows point packet `index`; one follows every 14th.
  SentPacket position_packet(std::uint64_t index) const;
  static constexpr std::uint64_t kPositionEvery = 14;

 private:
  int sequences() const { return (settings_.dual ? 6 : 12) * model_.sequences_per_block(); }
  double azimuth_deg(double t_s) const;
  Eigen::Vector3d direction(double t_s, std::size_t laser) const;
  void shoot_sequence(std::uint64_t index, int sequence, std::span<std::byte> bytes) const;
  void store(std::span<std::byte> bytes, std::size_t at, const Echo& echo) const;

  const SpinningModel& model_;
  SpinningSettings settings_;
  const Motion& motion_;
  geometry::Se3 T_base_lidar_;
  Noise noise_;
  Beam beam_;
  double phase_deg_;
  std::array<double, 32> beam_bias_m_{};
};

}  // namespace slamd::simulate
