#include "tools/simulate/faults.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include <nlohmann/json.hpp>

#include "drivers/recording/pcap_reader.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "decoded.hpp"
#include "temporary_folder.hpp"
#include "tools/replay/output.hpp"
#include "tools/replay/recording.hpp"
#include "tools/replay/replay.hpp"
#include "tools/simulate/simulate.hpp"
#include "tools/simulate/simulated_source.hpp"

namespace slamd::simulate {
namespace {

using nlohmann::json;

class FaultInjection : public TemporaryFolder {
 protected:
  std::filesystem::path recorded(LidarKind lidar, double duration_s) {
    Drive drive;
    drive.lidar = lidar;
    drive.duration_s = duration_s;
    const std::filesystem::path folder = made(name_of(lidar));
    simulate(drive, folder, nullptr);
    return folder;
  }

  json faults_of(const std::filesystem::path& out) { return json::parse(text_of(out / "faults.json")); }

  /// What report.json says of a replay.
  static json report_of(const std::filesystem::path& recording, const std::vector<std::string>& overrides = {}) {
    const replay::Recording opened = replay::open_recording(recording, {}, overrides);
    return json::parse(replay::report_json(opened, replay::replay(opened, {}), nullptr, ""));
  }
};

/// Everything at once.
Faults all_faults() {
  Faults faults;
  faults.seed = 7;
  faults.drop = 0.01;
  faults.burst = {3, 50};
  faults.reorder = 0.01;
  faults.duplicate = 0.01;
  faults.truncate = 0.005;
  faults.garbage = 0.005;
  faults.clock_steps = {{8.0, -0.5}, {14.0, 2.0}};
  faults.blackouts = {{11.0, 1.0}};
  faults.imu_gaps = {{9.0, 0.3}};
  faults.imu_offset_s = 0.008;
  faults.imu_clip = InertialLimits{0.5, 11.0};
  faults.block_fov = Sector{160.0, 200.0};
  return faults;
}

void expect_packets_as_injected(const json& faults, const json& report) {
  for (const auto& [name, count] : faults.at("report_packets").items()) {
    EXPECT_EQ(report.at("packets").value(name, std::uint64_t{0}), count.get<std::uint64_t>()) << name;
  }
  // And nothing else was refused.
  std::uint64_t reported = 0;
  std::uint64_t injected = 0;
  for (const auto& [name, count] : report.at("packets").items()) {
    reported += count.get<std::uint64_t>();
  }
  for (const auto& [name, count] : faults.at("report_packets").items()) {
    injected += count.get<std::uint64_t>();
  }
  EXPECT_EQ(reported, injected);
}

TEST_F(FaultInjection, OfEverythingAtOnceIsCountedByReplayAsItWasInjected) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    const std::filesystem::path in = recorded(lidar, 20.0);
    const std::filesystem::path out = made(std::string(name_of(lidar)) + "_out");

    inject_faults(in, out, all_faults(), nullptr);

    const json faults = faults_of(out);
    const json report = report_of(out);
    expect_packets_as_injected(faults, report);
    EXPECT_EQ(report.at("imu").at("rows"), faults.at("imu_rows").at("written"));
    std::uint64_t blocks = 0;
    for (const auto& [name, count] : report.at("blocks").items()) {
      blocks += name == "missing" ? 0 : count.get<std::uint64_t>();
    }
    EXPECT_EQ(blocks, report.at("packets").at(lidar == LidarKind::kVlp16 ? "data" : "points").get<std::uint64_t>());
    EXPECT_GE(report.at("scans").get<int>(), 100);
  }
}

TEST_F(FaultInjection, OfLateAndRepeatedPacketsIsCountedByReason) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    Faults faults;
    faults.reorder = 0.02;
    faults.duplicate = 0.02;
    const std::filesystem::path in = recorded(lidar, 10.0);
    const std::filesystem::path out = made(std::string(name_of(lidar)) + "_out");

    inject_faults(in, out, faults, nullptr);

    const json injected = faults_of(out);
    const json report = report_of(out);
    EXPECT_GT(injected.at("report_blocks").at("refused_late").get<int>(), 20);
    EXPECT_EQ(report.at("blocks").at("refused_late"), injected.at("report_blocks").at("refused_late"));
    EXPECT_EQ(report.at("blocks").at("refused_duplicate"), injected.at("report_blocks").at("refused_duplicate"));
    EXPECT_EQ(report.at("blocks").at("refused_backward"), 0);
  }
}

TEST_F(FaultInjection, OfLostPacketsIsNoticedAsMissingBlocks) {
  Faults faults;
  faults.drop = 0.02;
  faults.blackouts = {{5.0, 0.5}};
  const std::filesystem::path in = recorded(LidarKind::kVlp16, 10.0);
  const std::filesystem::path out = made("out");

  const FaultCounts counts = inject_faults(in, out, faults, nullptr);

  const PacketFaults& data = counts.of(Wire::kVelodyneData);
  EXPECT_NEAR(static_cast<double>(data.blackout), 0.5 / 1.327104e-3, 2.0);
  EXPECT_NEAR(static_cast<double>(data.dropped) / static_cast<double>(data.read), 0.02, 0.005);
  EXPECT_NEAR(report_of(out).at("blocks").at("missing").get<double>(),
              static_cast<double>(data.blackout + data.dropped), 3.0);
}

TEST_F(FaultInjection, WithoutFaultsCopiesEveryByte) {
  const std::filesystem::path in = recorded(LidarKind::kVlp16, 5.0);
  const std::filesystem::path out = made("out");

  inject_faults(in, out, {}, nullptr);

  for (const auto& entry : std::filesystem::directory_iterator(in)) {
    EXPECT_TRUE(text_of(entry.path()) == text_of(out / entry.path().filename())) << entry.path().filename();
  }
}

TEST_F(FaultInjection, HasTheSameBytesForTheSameSeedOnly) {
  const std::filesystem::path in = recorded(LidarKind::kLivoxAvia, 5.0);
  Faults faults = all_faults();
  inject_faults(in, made("one"), faults, nullptr);
  inject_faults(in, made("same"), faults, nullptr);
  faults.seed = 8;
  inject_faults(in, made("other"), faults, nullptr);

  EXPECT_TRUE(text_of(folder_ / "one" / "lidar.pcap") == text_of(folder_ / "same" / "lidar.pcap"));
  EXPECT_FALSE(text_of(folder_ / "one" / "lidar.pcap") == text_of(folder_ / "other" / "lidar.pcap"));
}

TEST_F(FaultInjection, WhileSimulatingGivesTheBytesOfADamagedCopy) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    Drive drive;
    drive.lidar = lidar;
    drive.duration_s = 10.0;
    Faults faults = all_faults();
    faults.clock_steps = {{4.0, -0.5}, {7.0, 2.0}};
    faults.blackouts = {{5.0, 1.0}};
    faults.imu_gaps = {{3.0, 0.3}};
    const std::filesystem::path copy = made(std::string(name_of(lidar)) + "_copy");
    inject_faults(recorded(lidar, 10.0), copy, faults, nullptr);
    drive.faults = faults;

    const std::filesystem::path sut = made(std::string(name_of(lidar)) + "_simulated");
    simulate(drive, sut, nullptr);

    for (const char* name : {"lidar.pcap", "imu.csv", "truth.tum", "faults.json"}) {
      EXPECT_TRUE(text_of(sut / name) == text_of(copy / name)) << name_of(lidar) << " " << name;
    }
  }
}

TEST_F(FaultInjection, IsTheSameInAStreamForReplay) {
  Drive drive;
  drive.duration_s = 10.0;
  drive.faults = all_faults();
  drive.faults->clock_steps = {{4.0, 2.0}};
  simulate(drive, folder_, nullptr);
  const Scene scene(drive);

  SimulatedSource sut(scene);

  recording::PcapReader reader(folder_ / "lidar.pcap");
  recording::Packet written;
  recording::Packet streamed;
  while (reader.next(written)) {
    ASSERT_TRUE(sut.next(streamed));
    ASSERT_EQ(streamed.received, written.received);
    ASSERT_TRUE(std::equal(streamed.payload.begin(), streamed.payload.end(), written.payload.begin(), written.payload.end()));
  }
  EXPECT_FALSE(sut.next(streamed));
  for (sensor::ImuSample sample; sut.next_imu(sample);) {
  }
  EXPECT_EQ(json::parse(faults_json(*drive.faults, *sut.faults())), faults_of(folder_));
}

TEST_F(FaultInjection, LeavesNothingInABlockedSector) {
  struct Case {
    LidarKind lidar;
    LivoxReturns returns;
    bool spherical;
  };
  for (const auto& [lidar, returns, spherical] :
       {Case{LidarKind::kVlp16, LivoxReturns::kFirst, false}, Case{LidarKind::kLivoxAvia, LivoxReturns::kFirst, false},
        Case{LidarKind::kLivoxAvia, LivoxReturns::kFirst, true}, Case{LidarKind::kLivoxAvia, LivoxReturns::kTriple, true}}) {
    Faults faults;
    faults.block_fov = lidar == LidarKind::kVlp16 ? Sector{150.0, -150.0} : Sector{-10.0, 10.0};
    const std::string name = std::string(name_of(lidar)) + std::to_string(static_cast<int>(returns)) + (spherical ? "s" : "");
    const std::filesystem::path in = made(name);
    Drive drive;
    drive.lidar = lidar;
    drive.duration_s = 5.0;
    drive.returns = returns;
    drive.spherical = spherical;
    simulate(drive, in, nullptr);
    const std::filesystem::path out = made(name + "_out");

    const FaultCounts counts = inject_faults(in, out, faults, nullptr);

    EXPECT_GT(counts.points_blocked, 10'000U);
    recording::PcapReader reader(out / "lidar.pcap");
    velodyne::Decoder velodyne({velodyne::Model::kVlp16, false});
    livox::LivoxDecoder livox{livox::LivoxConfig{}};
    livox::ImuReading imu;
    sensor::PointBlock block;
    std::uint64_t inside = 0;
    for (recording::Packet packet; reader.next(packet);) {
      block.points.clear();
      if (lidar == LidarKind::kVlp16) {
        velodyne.decode(packet.payload, packet.received, block);
      } else {
        livox.decode(packet.payload, packet.received, block, imu);
      }
      for (const sensor::Point& point : block.points) {
        const double azimuth_deg = std::atan2(point.y_m, point.x_m) * 180.0 / M_PI;
        const double from_middle =
            std::abs(lidar == LidarKind::kVlp16 ? std::remainder(azimuth_deg - 180.0, 360.0) : azimuth_deg);
        inside += from_middle < (lidar == LidarKind::kVlp16 ? 29.5 : 9.99) ? 1 : 0;
      }
    }
    EXPECT_EQ(inside, 0U);
  }
}

TEST_F(FaultInjection, ShiftsClipsAndInterruptsInertialSamples) {
  const std::filesystem::path in = recorded(LidarKind::kVlp16, 12.0);
  Faults faults;
  faults.imu_offset_s = 0.008;
  faults.imu_gaps = {{4.0, 0.5}};
  faults.imu_clip = InertialLimits{0.05, 9.9};

  const FaultCounts counts = inject_faults(in, made("out"), faults, nullptr);

  const auto first_stamp = [&](const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    std::getline(stream, line);
    return std::stoll(line);
  };
  EXPECT_EQ(first_stamp(folder_ / "out" / "imu.csv") - first_stamp(in / "imu.csv"), 8'000'000);
  EXPECT_EQ(counts.imu_rows_gap, 100U);
  EXPECT_GT(counts.imu_rows_clipped, 10U);
  EXPECT_EQ(counts.imu_rows_written, counts.imu_rows_read - counts.imu_rows_gap);
  double most = 0.0;
  std::ifstream stream(folder_ / "out" / "imu.csv");
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    const std::string rest = line.substr(line.find(',') + 1);
    most = std::max(most, std::abs(std::stod(rest)));
  }
  EXPECT_LE(most, 0.05);
}

TEST_F(FaultInjection, TakesDatagramsOfAnyLengthAndContent) {
  const std::filesystem::path in = folder_ / "odd.pcap";
  recording::PcapWriter writer(in);
  for (std::size_t length = 0; length < 120; ++length) {
    for (const int first : {0, 5, 0xAA, 0xFF}) {
      std::vector<std::byte> bytes(length);
      if (length > 10) {
        bytes[0] = static_cast<std::byte>(first);
        bytes[1] = static_cast<std::byte>(length);  // of an SDK2 packet
        bytes[9] = bytes[10] = static_cast<std::byte>(first == 5 ? 6 : 0);
      }
      recording::Packet packet;
      packet.received = Stamp{} + std::chrono::milliseconds(length);
      packet.payload = bytes;
      writer.write(packet);
    }
  }
  writer.close();
  Faults faults = all_faults();
  faults.garbage = 0.3;
  faults.blackouts.clear();
  faults.clock_steps = {{0.0, 0.5}};

  const FaultCounts counts = inject_faults(in, made("out"), faults, nullptr);

  std::uint64_t read = 0;
  for (const PacketFaults& packets : counts.packets) {
    read += packets.read;
  }
  EXPECT_EQ(read, 480U);
}

TEST_F(FaultInjection, SaysWhatIsWrongWithARecordingThatIsNone) {
  EXPECT_THROW(inject_faults(folder_ / "absent", made("out"), {}, nullptr), recording::RecordingError);
}

}  // namespace
}  // namespace slamd::simulate
