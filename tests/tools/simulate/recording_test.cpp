#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/geometry/se3.hpp"
#include "daemon/configuration/loader.hpp"
#include "drivers/livox/livox_decoder.hpp"
#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "drivers/recording/tum.hpp"
#include "drivers/velodyne/decoder.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/simulate/simulate.hpp"
#include "tools/simulate/town.hpp"

namespace slamd::simulate {
namespace {

namespace fs = std::filesystem;

class SimulatedRecording : public scratch::ScratchFolder {
 protected:
  fs::path made(const Drive& drive, const std::string& name) const {
    fs::create_directories(folder_ / name);
    simulate(drive, folder_ / name, nullptr);
    return folder_ / name;
  }
};

/// The truth of a recording at any time of it.
class Truth {
 public:
  explicit Truth(const fs::path& file) : poses_(recording::read_tum(file)) {}

  Stamp begin() const { return poses_.front().stamp; }
  Stamp end() const { return poses_.back().stamp; }

  geometry::Se3 at(Stamp stamp) const {
    const auto after = std::upper_bound(poses_.begin() + 1, poses_.end() - 1, stamp,
                                        [](Stamp s, const recording::StampedPose& pose) { return s < pose.stamp; });
    const auto before = after - 1;
    return geometry::interpolate(before->T, after->T, to_seconds(stamp - before->stamp) / to_seconds(after->stamp - before->stamp));
  }

 private:
  std::vector<recording::StampedPose> poses_;
};

/// Decodes a recording's packets and calls use(point block), its stamp set, for each.
template <typename Use>
void decode(const fs::path& recording, LidarKind lidar, Stamp start, Use&& use) {
  recording::PcapReader reader(recording / "lidar.pcap");
  velodyne::Decoder velodyne({velodyne::Model::kVlp16, false});
  livox::LivoxDecoder livox{livox::LivoxConfig{}};
  livox::ImuReading imu;
  sensor::PointBlock block;
  recording::Packet packet;
  std::optional<DeviceStamp> first;
  while (reader.next(packet)) {
    const bool points =
        lidar == LidarKind::kVlp16
            ? packet.destination_port == 2368 &&
                  velodyne.decode(packet.payload, packet.received, block) == velodyne::DecodeResult::kOk
            : livox.decode(packet.payload, packet.received, block, imu) == livox::DecodeResult::kPoints;
    if (points) {
      // The first packet's first firing is the start of the drive.
      first = first.value_or(block.device_stamp);
      block.stamp = start + (block.device_stamp - *first);
      use(block);
    }
  }
}

/// How far points lie beyond the surfaces that their rays meet.  Units: m.
std::vector<double> residuals_of(const fs::path& recording, const Drive& drive, std::size_t every) {
  configuration::Loader loader;
  loader.add_file(recording / "recording.toml");
  const geometry::Se3 T_base_lidar = loader.load().lidar.T_base_lidar;
  const Truth truth(recording / "truth.tum");
  const Town town(drive.seed);
  std::vector<double> residuals_m;
  std::size_t number = 0;
  decode(recording, drive.lidar, truth.begin(), [&](const sensor::PointBlock& block) {
    for (const sensor::Point& point : block.points) {
      const Stamp stamp = block.stamp + Duration(point.offset_ns);
      if (++number % every != 0 || stamp > truth.end()) {
        continue;
      }
      const geometry::Se3 T_world_lidar = truth.at(stamp) * T_base_lidar;
      const Eigen::Vector3d p_lidar(point.x_m, point.y_m, point.z_m);
      Hit hit;
      if (town.world().cast(T_world_lidar.translation(), T_world_lidar.rotation() * p_lidar.normalized(), 200.0, 0, hit)) {
        residuals_m.push_back(p_lidar.norm() - hit.range_m);
      }
    }
  });
  std::sort(residuals_m.begin(), residuals_m.end());
  return residuals_m;
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void expect_points_on_surfaces(const std::vector<double>& residuals_m) {
  ASSERT_GT(residuals_m.size(), 10'000U);
  // The beams' fixed errors leave a mean of up to 4 mm / √6 (1σ); perfect_lidar_test.cpp is strict.
  EXPECT_LT(std::abs(quantile(residuals_m, 0.5)), 0.005);
  // Range noise of 12 to 15 mm and 4 to 5 mm for each beam: a standard deviation of 13 to 16 mm.
  const double spread_m = 0.5 * (quantile(residuals_m, 0.8413) - quantile(residuals_m, 0.1587));
  EXPECT_GT(spread_m, 0.010);
  EXPECT_LT(spread_m, 0.022);
  // Leaves and edges hold the rest.
  const auto on_surface = std::count_if(residuals_m.begin(), residuals_m.end(), [](double r) { return std::abs(r) < 0.06; });
  EXPECT_GT(static_cast<double>(on_surface) / static_cast<double>(residuals_m.size()), 0.85);
}

TEST_F(SimulatedRecording, PutsVlp16PointsOnTheSurfacesOfTheTown) {
  const Drive drive{.lidar = LidarKind::kVlp16, .seed = 3, .duration_s = 4.0, .rest_s = 0.5};

  const fs::path sut = made(drive, "sut");

  expect_points_on_surfaces(residuals_of(sut, drive, 10));
}

TEST_F(SimulatedRecording, PutsAviaPointsOnTheSurfacesOfTheTown) {
  const Drive drive{.lidar = LidarKind::kLivoxAvia, .seed = 3, .duration_s = 3.0, .rest_s = 0.5};

  const fs::path sut = made(drive, "sut");

  expect_points_on_surfaces(residuals_of(sut, drive, 10));
}

TEST_F(SimulatedRecording, HasTheSameBytesForTheSameSeedWithAnyNumberOfThreads) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    const fs::path one = made({.lidar = lidar, .seed = 5, .duration_s = 1.5, .rest_s = 0.5, .threads = 1}, "one");
    const fs::path two = made({.lidar = lidar, .seed = 5, .duration_s = 1.5, .rest_s = 0.5, .threads = 2}, "two");

    int files = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(one)) {
      EXPECT_TRUE(text_of(entry.path()) == text_of(two / entry.path().filename())) << entry.path().filename();
      ++files;
    }
    EXPECT_GE(files, 5);
  }
}

TEST_F(SimulatedRecording, HasOtherBytesForAnotherSeed) {
  const fs::path one = made({.seed = 5, .duration_s = 0.5}, "one");
  const fs::path other = made({.seed = 6, .duration_s = 0.5}, "other");

  EXPECT_FALSE(text_of(one / "lidar.pcap") == text_of(other / "lidar.pcap"));
  EXPECT_FALSE(text_of(one / "imu.csv") == text_of(other / "imu.csv"));
}

TEST_F(SimulatedRecording, CoversTheDriveWithEachSensor) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    const Drive drive{.lidar = lidar, .seed = 2, .duration_s = 2.0, .rest_s = 0.5, .imu_rate_hz = 250.0};

    const fs::path sut = made(drive, "sut");

    const Truth truth(sut / "truth.tum");
    EXPECT_NEAR(to_seconds(truth.end() - truth.begin()), drive.duration_s, 0.5);
    recording::ImuCsvReader imu(sut / "imu.csv");
    sensor::ImuSample sample;
    while (imu.next(sample)) {
    }
    EXPECT_NEAR(static_cast<double>(imu.counters().rows), drive.imu_rate_hz * to_seconds(truth.end() - truth.begin()), 5.0);
    EXPECT_NEAR(to_seconds(sample.stamp - truth.end()), 0.0, 0.02);
    Stamp last{};
    Duration gap{};
    decode(sut, lidar, truth.begin(), [&](const sensor::PointBlock& block) {
      gap = last == Stamp{} ? gap : std::max(gap, block.stamp - last);
      last = block.stamp;
      EXPECT_GT(block.received, block.stamp);
      EXPECT_LT(block.received, block.stamp + std::chrono::milliseconds(10));
    });
    EXPECT_LT(gap, std::chrono::milliseconds(2));
    EXPECT_NEAR(to_seconds(last - truth.end()), 0.0, 0.1);
  }
}

TEST_F(SimulatedRecording, StandsStillForTheRestAndMovesAfterIt) {
  const fs::path sut = made({.seed = 2, .duration_s = 5.0, .speed_mps = 1.6, .rest_s = 1.0}, "sut");

  const Truth truth(sut / "truth.tum");
  const auto moved_m = [&](double from_s, double to_s) {
    return (truth.at(truth.begin() + from_seconds(to_s)).translation() - truth.at(truth.begin() + from_seconds(from_s)).translation()).norm();
  };
  EXPECT_LT(moved_m(0.0, 0.7), 0.005);
  EXPECT_GT(moved_m(1.0, 3.0), 0.5);
}

}  // namespace
}  // namespace slamd::simulate
