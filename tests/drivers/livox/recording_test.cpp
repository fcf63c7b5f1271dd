#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "drivers/livox/livox_decoder.hpp"
#include "drivers/recording/pcap_reader.hpp"

namespace slamd::livox {
namespace {

// Another simulator's bytes: 14 s of an Avia in single-return mode with its own IMU.
TEST(LivoxRecording, LeavesNoPacketOfTownAviaUnexplained) {
  const std::filesystem::path file =
      std::filesystem::path(SLAMD_SHARED_DATA_DIR) / "recordings/town_avia/lidar.pcap";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << file << " is not there";
  }
  recording::PcapReader reader(file);
  LivoxDecoder sut{LivoxConfig{}};
  sensor::PointBlock block;
  ImuReading imu;
  recording::Packet packet;
  std::uint64_t packets = 0;
  std::uint64_t firings = 0;
  std::uint64_t irregular_blocks = 0;
  Eigen::Vector3d force_sum_mps2 = Eigen::Vector3d::Zero();
  std::optional<DeviceStamp> expected;

  while (reader.next(packet)) {
    ++packets;
    const DecodeResult result = sut.decode(packet.payload, packet.received, block, imu);
    if (result == DecodeResult::kPoints) {
      firings += block.points.size() + block.empty_firings;
      irregular_blocks += expected && block.device_stamp != *expected ? 1 : 0;
      expected = block.device_stamp + block.duration;
    } else if (result == DecodeResult::kImu) {
      force_sum_mps2 += imu.specific_force_mps2;
    }
  }

  const LivoxCounters& counters = sut.counters();
  const std::uint64_t inertial = counters.of(DecodeResult::kImu);
  const std::uint64_t data = counters.of(DecodeResult::kPoints);
  EXPECT_EQ(inertial + data, packets);
  EXPECT_NEAR(static_cast<double>(data) / static_cast<double>(inertial), 12.5, 0.1);  // 2500 : 200
  EXPECT_EQ(firings + counters.out_of_range, 96 * data);
  EXPECT_EQ(counters.bad_angles, 0U);
  EXPECT_EQ(irregular_blocks, 0U);
  EXPECT_NEAR((force_sum_mps2 / static_cast<double>(inertial)).norm(), 9.81, 0.15);
}

}  // namespace
}  // namespace slamd::livox
