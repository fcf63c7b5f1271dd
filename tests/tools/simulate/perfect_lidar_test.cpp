#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"
#include "drivers/livox/livox_decoder.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "tools/simulate/livox_lidar.hpp"
#include "tools/simulate/spinning_lidar.hpp"
#include "tools/simulate/town.hpp"

namespace slamd::simulate {
namespace {

// LiDARs without errors, read by the project's decoders: what is left is the rounding of the packets.

constexpr double kFar_m = 100.0;
constexpr RangeErrors kPerfect{.noise_m = 0.0, .beam_bias_m = 0.0, .max_range_m = kFar_m, .min_range_m = 0.4};

/// A sensor away from base and turned, so that lever arm and rotation count.
geometry::Se3 mounting() { return {geometry::rotation_from_rpy({0.05, -0.1, 0.8}), {0.3, -0.2, 0.6}}; }

class PerfectLidar : public testing::Test {
 protected:
  PerfectLidar() : town_(4), motion_(town_.tour(20.0, 3.0, 0.5, 0.45)) {}

  /// Takes a block whose first firing was at `begin_s`.
  void add(const sensor::PointBlock& block, double begin_s) {
    for (const sensor::Point& point : block.points) {
      const geometry::Se3 T_world_lidar = motion_.pose_at(begin_s + 1e-9 * point.offset_ns) * mounting();
      const Eigen::Vector3d p_lidar(point.x_m, point.y_m, point.z_m);
      Hit hit;
      if (town_.world().cast(T_world_lidar.translation(), T_world_lidar.rotation() * p_lidar.normalized(), 2.0 * kFar_m, 0, hit)) {
        residuals_m_.push_back(p_lidar.norm() - hit.range_m);
      }
    }
  }

  void expect_points_on_surfaces() {
    ASSERT_GT(residuals_m_.size(), 10'000U);
    std::sort(residuals_m_.begin(), residuals_m_.end());
    EXPECT_LT(std::abs(residuals_m_[residuals_m_.size() / 2]), 0.001);
    const auto near = std::count_if(residuals_m_.begin(), residuals_m_.end(), [](double r) { return std::abs(r) < 0.01; });
    EXPECT_GT(static_cast<double>(near) / static_cast<double>(residuals_m_.size()), 0.85);  // leaves hold the rest
  }

  Town town_;
  Motion motion_;
  std::vector<double> residuals_m_;
};

TEST_F(PerfectLidar, PutsVlp16PointsOnTheSurfacesOfTheTown) {
  const SpinningLidar sut(town_.world(), motion_, mounting(), kPerfect, 4);
  velodyne::Decoder decoder({velodyne::Model::kVlp16, false});
  sensor::PointBlock block;

  for (std::uint64_t index = 3000; index < 9000; index += 60) {
    const SentPacket packet = sut.data_packet(index, 100.0);

    ASSERT_EQ(decoder.decode(packet.payload, Stamp{}, block), velodyne::DecodeResult::kOk);

    add(block, std::chrono::duration<double>(block.device_stamp.time_since_epoch()).count() - 100.0);
  }
  expect_points_on_surfaces();
}

TEST_F(PerfectLidar, PutsAviaPointsOnTheSurfacesOfTheTown) {
  const LivoxLidar sut(town_.world(), motion_, mounting(), kPerfect, 4);
  livox::LivoxDecoder decoder{livox::LivoxConfig{}};
  livox::ImuReading imu;
  sensor::PointBlock block;

  for (std::uint64_t index = 5000; index < 40'000; index += 70) {
    const SentPacket packet = sut.point_packet(index);

    ASSERT_EQ(decoder.decode(packet.payload, Stamp{}, block, imu), livox::DecodeResult::kPoints);

    add(block, 1e-9 * static_cast<double>(block.device_stamp.time_since_epoch().count() -
                                          static_cast<std::int64_t>(LivoxLidar::kPowerUp_ns)));
  }
  expect_points_on_surfaces();
}

TEST_F(PerfectLidar, MakesTheSamePacketWhateverWasMadeBefore) {
  const SpinningLidar sut(town_.world(), motion_, mounting(), RangeErrors{}, 4);
  const SpinningLidar other(town_.world(), motion_, mounting(), RangeErrors{}, 4);

  const SentPacket before = sut.data_packet(500, 0.0);
  for (std::uint64_t index = 0; index < 20; ++index) {
    other.data_packet(index, 0.0);
  }

  EXPECT_EQ(other.data_packet(500, 0.0).payload, before.payload);
  EXPECT_EQ(other.data_packet(500, 0.0).sent_s, before.sent_s);
}

}  // namespace
}  // namespace slamd::simulate
