#include "tools/replay/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "core/mapping/corrections.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "drivers/storage/ply_reader.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/replay/output.hpp"
#include "tools/replay/session.hpp"
#include "tools/simulate/simulate.hpp"

namespace slamd::replay {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A drive of a few seconds, simulated once for all tests.
class Replay : public scratch::ScratchFolder {
 protected:
  static void SetUpTestSuite() {
    drive_ = fs::path(testing::TempDir()) / ("slamd_replay_drive_" + std::to_string(getpid()));
    fs::create_directories(drive_);
    simulate::simulate({.seed = 3, .duration_s = 4.5, .rest_s = 1.4}, drive_, nullptr);
  }

  static void TearDownTestSuite() { fs::remove_all(drive_); }

  static replay::Run run_of(const Recording& recording) { return replay::replay(recording, {}); }

  /// The drive with another capture in place of its own.
  Recording with_capture(const std::string& bytes) const {
    Recording recording = open_recording(drive_, {}, {});
    recording.lidar = write("lidar.pcap", bytes);
    return recording;
  }

  static std::uint64_t count_of(const stages::NamedCounts& counts, const std::string& name) {
    for (const auto& [key, count] : counts) {
      if (key == name) {
        return count;
      }
    }
    return 0;
  }

  inline static fs::path drive_;
};

TEST_F(Replay, GivesTheSameBytesEachTime) {
  for (const char* name : {"one", "two"}) {
    fs::create_directories(folder_ / name);
    Session sut(open_recording(drive_, {}, {}), folder_ / name);
    sut.run(nullptr);
  }

  for (const char* file : {"odometry.tum", "trajectory.tum", "scans.csv", "map.ply"}) {
    const std::string bytes = text_of(folder_ / "one" / file);
    EXPECT_GT(bytes.size(), 1000U) << file;
    EXPECT_TRUE(bytes == text_of(folder_ / "two" / file)) << file;
  }
}

TEST_F(Replay, AccountsForEachScanAndEachPacket) {
  const replay::Run sut = run_of(open_recording(drive_, {}, {}));

  EXPECT_GT(sut.scans.size(), 30U);
  EXPECT_EQ(sut.scans_seen, sut.scans.size() + sut.scans_before_start);
  EXPECT_GT(count_of(sut.packets, "data"), 3000U);
  EXPECT_GT(count_of(sut.packets, "position"), 200U);
  EXPECT_EQ(count_of(sut.blocks, "accepted"), count_of(sut.packets, "data"));
  EXPECT_EQ(count_of(sut.imu, "rows"), count_of(sut.imu, "accepted"));
  EXPECT_TRUE(sut.alignment.has_value());
}

TEST_F(Replay, GivesOnePoseAScanInTheOrderOfTime) {
  const replay::Run sut = run_of(open_recording(drive_, {}, {}));

  for (std::size_t i = 1; i < sut.scans.size(); ++i) {
    const double step_s = to_seconds(sut.scans[i].odometry.stamp - sut.scans[i - 1].odometry.stamp);
    EXPECT_NEAR(step_s, 0.1, i + 1 == sut.scans.size() ? 0.1 : 0.002);
  }
}

TEST_F(Replay, KeepsWhatCameBeforeTheEndOfACaptureThatIsCutOff) {
  const std::string whole = text_of(drive_ / "lidar.pcap");
  const replay::Run untouched = run_of(open_recording(drive_, {}, {}));

  const replay::Run sut = run_of(with_capture(whole.substr(0, whole.size() * 3 / 4 + 7)));

  ASSERT_GT(sut.scans.size(), 20U);
  ASSERT_LT(sut.scans.size(), untouched.scans.size());
  for (std::size_t i = 0; i + 1 < sut.scans.size(); ++i) {  // the last scan is cut off itself
    EXPECT_EQ(sut.scans[i].odometry.stamp, untouched.scans[i].odometry.stamp);
    EXPECT_EQ(sut.scans[i].odometry.T_odom_base.translation(), untouched.scans[i].odometry.T_odom_base.translation());
  }
  ASSERT_EQ(sut.remarks.size(), 1U);
  EXPECT_EQ(sut.remarks[0], "the capture ends in the middle of a record");
}

TEST_F(Replay, CountsForeignAndBrokenPacketsByReasonAndDrivesOnAsIfTheyWereNotThere) {
  const replay::Run untouched = run_of(open_recording(drive_, {}, {}));
  Recording recording = open_recording(drive_, {}, {});
  {
    recording::PcapReader reader(recording.lidar);
    recording.lidar = folder_ / "mixed.pcap";
    recording::PcapWriter writer(recording.lidar);
    recording::Packet packet;
    for (std::uint64_t number = 0; reader.next(packet); ++number) {
      writer.write(packet);
      std::vector<std::byte> bytes(packet.payload.begin(), packet.payload.end());
      recording::Packet intruder = packet;
      intruder.payload = bytes;
      if (number % 100 == 10) {
        intruder.destination_port = 7502;
        writer.write(intruder);
      } else if (number % 100 == 30 && packet.destination_port == 2368) {
        intruder.payload = std::span<const std::byte>(bytes).first(600);
        writer.write(intruder);
      } else if (number % 100 == 50 && packet.destination_port == 2368) {
        bytes[0] ^= std::byte{0x10};  // the first block's flag
        writer.write(intruder);
      } else if (number % 100 == 70 && packet.destination_port == 2368) {
        bytes[3] = std::byte{0xFF};  // an azimuth beyond a turn
        writer.write(intruder);
      }
    }
    writer.close();
  }

  const replay::Run sut = run_of(recording);

  EXPECT_GT(count_of(sut.packets, "foreign_port"), 30U);
  for (const auto reason : {velodyne::DecodeResult::kWrongLength, velodyne::DecodeResult::kBadBlockFlag,
                            velodyne::DecodeResult::kBadAzimuth}) {
    EXPECT_GT(count_of(sut.packets, std::string("refused_") + velodyne::name_of(reason)), 30U) << velodyne::name_of(reason);
  }
  EXPECT_EQ(count_of(sut.packets, "data"), count_of(untouched.packets, "data"));
  EXPECT_EQ(count_of(sut.packets, "position"), count_of(untouched.packets, "position"));
  ASSERT_EQ(sut.scans.size(), untouched.scans.size());
  for (std::size_t i = 0; i < sut.scans.size(); ++i) {
    ASSERT_EQ(sut.scans[i].odometry.stamp, untouched.scans[i].odometry.stamp);
    ASSERT_EQ(sut.scans[i].odometry.T_odom_base.translation(), untouched.scans[i].odometry.T_odom_base.translation());
  }
}

TEST_F(Replay, RunsWithoutAnInertialSensor) {
  const replay::Run sut = run_of(open_recording(drive_, {}, {"imu.enabled=false"}));

  EXPECT_GT(sut.scans.size(), 40U);
  EXPECT_LE(sut.scans_before_start, 1U);  // the part of a revolution at its beginning
  EXPECT_FALSE(sut.alignment.has_value());
}

TEST_F(Replay, ReportsHowFarItIs) {
  std::vector<double> shares;

  replay::replay(open_recording(drive_, {}, {}), {nullptr, [&](double share) { shares.push_back(share); }});

  ASSERT_GT(shares.size(), 30U);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GE(shares.front(), 0.0);
  EXPECT_LE(shares.back(), 1.0);
  EXPECT_GT(shares.back(), 0.9);
}

TEST_F(Replay, WritesAllThatScriptsRelyOnIntoItsReport) {
  Session session(open_recording(drive_, {}, {}), folder_);
  session.run(nullptr);
  session.compare("iekf", nullptr);
  session.write_reports();

  const json sut = json::parse(text_of(folder_ / "report.json"));

  for (const char* key : {"state", "scans", "scans_dropped", "packets", "cpu_ms_per_scan", "stage_ms", "rss_max_mb",
                          "realtime_factor", "swarm", "loops", "states"}) {
    EXPECT_TRUE(sut.contains(key)) << key;
  }
  for (const char* key : {"median", "p95", "p99", "max"}) {
    EXPECT_GT(sut["cpu_ms_per_scan"][key].get<double>(), 0.0) << key;
    EXPECT_TRUE(sut["stage_ms"]["odometry"].contains(key)) << key;
  }
  for (const char* key : {"small", "recovery", "won"}) {
    EXPECT_TRUE(sut["swarm"].contains(key)) << key;
  }
  for (const char* key : {"candidates", "verified", "accepted", "removed"}) {
    EXPECT_TRUE(sut["loops"].contains(key)) << key;
  }
  double time_s = 0.0;
  std::size_t scans = 0;
  for (const auto& [state, of_state] : sut["states"].items()) {
    time_s += of_state["time_s"].get<double>();
    scans += of_state["scans"].get<std::size_t>();
    EXPECT_TRUE(of_state["causes"].is_object()) << state;
  }
  EXPECT_EQ(scans, sut["scans"]);
  EXPECT_NEAR(time_s, 0.1 * static_cast<double>(scans), 0.2);
  EXPECT_LT(sut["accuracy"]["psf"]["ape_rmse_m"].get<double>(), 0.05);
  EXPECT_LT(sut["accuracy"]["iekf"]["ape_rmse_m"].get<double>(), 0.05);
  EXPECT_GT(text_of(folder_ / "odometry-iekf.tum").size(), 1000U);
  EXPECT_NE(text_of(folder_ / "report.html").find("</html>"), std::string::npos);
}

TEST_F(Replay, MapsWithoutMappingAsWithIt) {
  std::string odometry[2];
  for (const bool use : {false, true}) {
    const fs::path out = folder_ / (use ? "with" : "without");
    fs::create_directories(out);
    Session session(open_recording(drive_, {}, {use ? "mapping.use=true" : "mapping.use=false"}), out);
    session.run(nullptr);
    session.write_reports();
    odometry[use ? 1 : 0] = text_of(out / "odometry.tum");
    EXPECT_EQ(fs::exists(out / "loop_trials.csv"), use);
    EXPECT_EQ(json::parse(text_of(out / "report.json")).contains("mapping"), use);
    EXPECT_TRUE(text_of(out / "trajectory.tum") == odometry[use ? 1 : 0]) << "no loop: map is odom";
  }

  EXPECT_GT(odometry[0].size(), 1000U);
  EXPECT_TRUE(odometry[0] == odometry[1]);
}

TEST_F(Replay, PutsEachScansPointsWhereItsCorrectionSays) {
  ScanRecord record;
  record.odometry.map_updated = true;
  scan::DeskewedScan scan(scan::PreprocessConfig{});
  scan.map_points_imu.push_back({1.0F, 2.0F, 3.0F});
  ProductWriter sut(folder_, 0.1);
  const geometry::Se3 shift(Eigen::Matrix3d::Identity(), {0.0, 0.5, 0.0});
  std::vector<mapping::CorrectedKeyframe> keyframes;
  for (int i = 0; i < 2; ++i) {  // the second scan sees the same point 5 m farther on, and is corrected by half a metre to the side
    record.odometry.stamp = Stamp{} + std::chrono::seconds(i);
    record.odometry.T_odom_base = geometry::Se3(Eigen::Matrix3d::Identity(), {5.0 * i, 0.0, 0.0});
    record.odometry.T_odom_imu = record.odometry.T_odom_base;
    sut.add(record, scan, odometry::MotionStep{});
    keyframes.push_back({record.odometry.stamp, record.odometry.T_odom_base,
                         i == 0 ? record.odometry.T_odom_base : record.odometry.T_odom_base * shift});
  }

  const mapping::CorrectedPath path(keyframes);
  sut.close(&path);

  storage::PlyReader map(folder_ / "map.ply");
  EXPECT_TRUE(map.read().isApprox(Eigen::Vector3f(1.0F, 2.0F, 3.0F), 1e-6F));
  EXPECT_TRUE(map.read().isApprox(Eigen::Vector3f(6.0F, 2.5F, 3.0F), 1e-6F));
  EXPECT_NEAR(sut.trajectory()[1].T.translation().y(), 0.5, 1e-12);
  EXPECT_EQ(text_of(folder_ / "odometry.tum").find("0.500000000"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "map.ply.odom"));
}

TEST(TimeSummaries, GiveMedianPercentilesAndMaximumOfAnyOrder) {
  std::vector<double> values(1000);
  std::iota(values.rbegin(), values.rend(), 0.0);

  const TimeSummary sut = summary_of(values);

  EXPECT_EQ(sut.median, 500.0);
  EXPECT_EQ(sut.p95, 950.0);
  EXPECT_EQ(sut.p99, 990.0);
  EXPECT_EQ(sut.max, 999.0);
  EXPECT_EQ(summary_of({}).max, 0.0);
  EXPECT_EQ(summary_of({3.0}).p99, 3.0);
}

}  // namespace
}  // namespace slamd::replay
