#include <gtest/gtest.h>

#include "temporary_folder.hpp"
#include "tools/replay/output.hpp"
#include "tools/replay/recording.hpp"
#include "tools/simulate/preview.hpp"
#include "tools/simulate/simulate.hpp"
#include "tools/simulate/simulated_source.hpp"
#include "tools/simulate/truth.hpp"

namespace slamd::simulate {
namespace {

class PacketStreams : public TemporaryFolder {};

TEST_F(PacketStreams, HaveTheSameBytesForAnyNumberOfThreads) {
  for (const LidarKind lidar :
       {LidarKind::kVlp16, LidarKind::kHdl32e, LidarKind::kLivoxAvia, LidarKind::kLivoxMid360}) {
    Drive drive;
    drive.lidar = lidar;
    drive.duration_s = 6.0;
    drive.rest_s = 0.0;
    drive.dual = true;
    drive.returns = LivoxReturns::kTriple;
    drive.mixed_pixels = true;
    drive.drops_per_m = 0.002;
    drive.extras = {3, 3};
    drive.threads = 1;
    const Scene one(drive);
    drive.threads = 3;
    const Scene three(drive);
    PacketStream a(one);
    PacketStream b(three);
    const SentPacket* from_a = nullptr;
    const SentPacket* from_b = nullptr;
    while (a.next(from_a)) {
      ASSERT_TRUE(b.next(from_b));
      ASSERT_EQ(from_a->sent_s, from_b->sent_s);
      ASSERT_TRUE(from_a->payload == from_b->payload);
    }
    EXPECT_FALSE(b.next(from_b));
  }
}

TEST_F(PacketStreams, AreInTheOrderOfSendingAndWhole) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    Drive drive;
    drive.lidar = lidar;
    drive.returns = LivoxReturns::kTriple;
    drive.duration_s = 5.0;
    const Scene scene(drive);
    PacketStream sut(scene);
    double last_s = 0.0;
    std::uint64_t points = 0;
    for (const SentPacket* packet = nullptr; sut.next(packet);) {
      ASSERT_GE(packet->sent_s, last_s);
      last_s = packet->sent_s;
      points += packet->payload.size() > 600 ? 1 : 0;
    }
    EXPECT_EQ(points, scene.packets());
  }
}

TEST_F(PacketStreams, GiveReplayWhatARecordingGives) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    Drive drive;
    drive.lidar = lidar;
    drive.duration_s = 8.0;
    const std::filesystem::path recorded = made(name_of(lidar));
    simulate(drive, recorded, nullptr);
    const Scene scene(drive);
    SimulatedSource sut(scene);

    const replay::Run from_file = replay::replay(replay::open_recording(recorded, {}, {}), {});
    const replay::Run from_stream = replay::replay(configuration_of(drive, {}), sut, {});

    ASSERT_GT(from_file.scans.size(), 30U);
    ASSERT_EQ(from_stream.scans.size(), from_file.scans.size());
    for (std::size_t i = 0; i < from_file.scans.size(); ++i) {
      EXPECT_EQ(from_stream.scans[i].odometry.stamp, from_file.scans[i].odometry.stamp);
      EXPECT_EQ(from_stream.scans[i].odometry.T_odom_base.translation(),
                from_file.scans[i].odometry.T_odom_base.translation());
    }
    EXPECT_EQ(from_stream.packets, from_file.packets);
    EXPECT_EQ(from_stream.imu, from_file.imu);
  }
}

TEST_F(PacketStreams, ComeWithEveryFileThatARecordingHas) {
  Drive drive;
  drive.duration_s = 6.0;
  drive.map = true;

  simulate(drive, folder_, nullptr);

  for (const char* name : {"lidar.pcap", "imu.csv", "odom.csv", "gnss.csv", "truth.tum", "loops.csv", "true_map.ply",
                           "recording.toml", "simulation.json"}) {
    EXPECT_GT(std::filesystem::file_size(folder_ / name), 0U) << name;
  }
  EXPECT_EQ(
      text_of(folder_ / "odom.csv").rfind("timestamp_ns,left_m_s,right_m_s,left_ticks,right_ticks,v_m_s,w_rad_s\n", 0),
      0U);
  EXPECT_EQ(text_of(folder_ / "gnss.csv")
                .rfind("timestamp_ns,quality,lat_deg,lon_deg,alt_m,sats,hdop,speed_m_s,course_deg\n", 0),
            0U);
  EXPECT_EQ(
      text_of(folder_ / "imu.csv").rfind("timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2,temp_c\n", 0),
      0U);
}

TEST_F(PacketStreams, HaveATrueMapOnTheWorldsSurfaces) {
  Drive drive;
  drive.duration_s = 30.0;
  drive.world = "warehouse";
  const Scene scene(drive);

  const std::vector<Eigen::Vector3f> sut = true_map(scene, 0.1);

  ASSERT_GT(sut.size(), 20'000U);
  // A ray from above the path to each point ends there or before it.
  const Eigen::Vector3d eye = scene.motion().pose_at(10.0).translation();
  for (std::size_t i = 0; i < sut.size(); i += 97) {
    const Eigen::Vector3d d = sut[i].cast<double>() - eye;
    Hit hit;
    ASSERT_TRUE(scene.world().cast(eye, d.normalized(), d.norm() + 0.01, 0, hit));
    ASSERT_LE(hit.range_m, d.norm() + 0.001);
  }
}

TEST_F(PacketStreams, ArePreviewedWithPathAndScan) {
  Drive drive;
  drive.duration_s = 60.0;
  const plot::IndexedImage sut = preview_of(Scene(drive), 320);

  EXPECT_EQ(sut.pixels.size(), sut.width * sut.height);
  EXPECT_GT(std::count(sut.pixels.begin(), sut.pixels.end(), 1), 60);   // path
  EXPECT_GT(std::count(sut.pixels.begin(), sut.pixels.end(), 2), 300);  // scan
}

}  // namespace
}  // namespace slamd::simulate
