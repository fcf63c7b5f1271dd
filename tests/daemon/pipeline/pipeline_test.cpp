#include "daemon/pipeline/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstring>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "daemon/configuration/loader.hpp"
#include "daemon/pipeline/health_monitor.hpp"
#include "drivers/transport/transport_error.hpp"
#include "tests/daemon/pipeline/room_drive.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::pipeline {
namespace {

using configuration::Configuration;

/// A UDP socket that plays a sensor on loopback.
class Sensor {
 public:
  Sensor() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Sensor() { close(fd_); }
  Sensor(const Sensor&) = delete;
  Sensor& operator=(const Sensor&) = delete;

  void send(std::span<const std::byte> payload, int port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(sendto(fd_, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to),
              static_cast<ssize_t>(payload.size()));
  }

 private:
  int fd_;
};

/// What a sensor sends at one moment.
struct Event {
  Stamp at{};
  int port = 0;
  std::vector<std::byte> payload;
};

constexpr int kLidarPort = 22368;
constexpr int kPositionPort = 28308;
constexpr int kImuPort = 27501;

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// A drive of a few seconds in a room, made once: LiDAR and inertial sensor as they would come over the network.
class Live : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const RoomDrive drive = drive_in_room(1.3, 3.5);
    for (const LidarPacket& packet : drive.packets) {
      events_.push_back({packet.received, kLidarPort, packet.payload});
    }
    for (const sensor::ImuSample& sample : drive.samples) {
      char row[200];
      const Eigen::Vector3d& w = sample.angular_rate_radps;
      const Eigen::Vector3d& f = sample.specific_force_mps2;
      std::snprintf(row, sizeof row, "%" PRId64 ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
                    static_cast<std::int64_t>(sample.stamp.time_since_epoch().count()), w.x(), w.y(), w.z(), f.x(), f.y(), f.z());
      events_.push_back({sample.stamp + std::chrono::microseconds(200), kImuPort, bytes_of(row)});
    }
    lidar_packets_ = drive.packets.size();
    imu_rows_ = drive.samples.size();
    std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) { return a.at < b.at; });
  }

  static Configuration configuration(const std::string& more = "") {
    configuration::Loader loader;
    loader.add_text("[[lidar]]\nmodel = \"vlp16\"\nport = " + std::to_string(kLidarPort) +
                        "\nposition_port = " + std::to_string(kPositionPort) +
                        "\nbind_address = \"127.0.0.1\"\nT_base_lidar = { xyz_m = [0.12, 0.0, 0.26], rpy_deg = [0.0, 0.0, 0.0] }\n"
                        "[imu]\nsource = \"udp\"\nport = " +
                        std::to_string(kImuPort) + "\n[lcm]\nurl = \"memq://\"\n[odometry]\nmax_points = 40000\n" + more,
                    "test.toml");
    return loader.load();
  }

  /// Sends all events from begin to end with their timing.
  static void play(std::size_t begin, std::size_t end) {
    const Sensor sensor;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = begin; i < end; ++i) {
      std::this_thread::sleep_until(start + (events_[i].at - events_[begin].at));
      sensor.send(events_[i].payload, events_[i].port);
    }
  }

  template <typename Condition>
  static bool comes_true(Condition&& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }

  inline static std::vector<Event> events_;
  inline static std::uint64_t lidar_packets_ = 0;
  inline static std::uint64_t imu_rows_ = 0;
};

TEST_F(Live, TracksADriveAndAccountsForEveryPacketAndSample) {
  const transport::HostClock clock;
  Pipeline sut(configuration(), clock);
  sut.start();

  play(0, events_.size());

  EXPECT_TRUE(comes_true([&] {
    const ReceiveCounts counts = sut.receive().counts();
    return counts.lidar.received + counts.lidar.kernel_lost == lidar_packets_ && counts.imu.received + counts.imu.kernel_lost == imu_rows_;
  }));
  EXPECT_TRUE(comes_true([&] { return sut.odometry().counts().scans + sut.odometry().counts().skipped >= 15; }));
  EXPECT_TRUE(comes_true([&] { return sut.mapping()->counts().scans + sut.publish().counts().scans_unmapped == sut.publish().counts().scans; }));
  sut.stop();
  EXPECT_EQ(sut.rings().points_pool.exhausted(), sut.publish().counts().clouds_unmapped);
  const OdometryCounts odometry = sut.odometry().counts();
  EXPECT_GE(odometry.scans, 1U);
  EXPECT_NE(odometry.state, odometry::State::kLost);
  EXPECT_GT(sut.publish().counts().poses, 100U);
  EXPECT_EQ(sut.receive().counts().lidar.dropped, 0U);
  EXPECT_EQ(sut.receive().counts().blocks_dropped, 0U);
  EXPECT_EQ(sut.receive().counts().samples_dropped, 0U);
}

TEST_F(Live, SaysWhatIsSilentAndGoesOnWhenItReturns) {
  const transport::HostClock clock;
  const Configuration configured = configuration();
  Pipeline sut(configured, clock);
  HealthMonitor health(configured, clock.now());
  const auto first_cause = [&] {
    const bus::Health now = health.read(sut, clock.now());
    return now.causes.empty() ? std::string() : std::string(now.causes[0].view());
  };
  sut.start();
  EXPECT_EQ(first_cause(), "vlp16: nothing received yet");
  EXPECT_EQ(health.read(sut, clock.now(), "held by another host").causes[0].view(), "vlp16: held by another host");

  const std::size_t half = events_.size() * 7 / 10;
  play(0, half);
  EXPECT_TRUE(comes_true([&] { return sut.odometry().counts().scans > 0; }));
  EXPECT_TRUE(comes_true([&] { return first_cause().find("vlp16: silent for") == 0; }));
  const std::uint64_t before = sut.odometry().counts().scans;
  const std::size_t heard = half + 10;  // packets that make no scan yet
  play(half, heard);
  bus::Health again;
  EXPECT_TRUE(comes_true([&] {
    again = health.read(sut, clock.now());
    return again.sensors[0].state == bus::SensorState::kRunning;
  }));
  EXPECT_EQ(again.state, bus::State::kDegraded);
  EXPECT_EQ(again.causes[again.causes.size() - 1].view(), "no scans");
  play(heard, events_.size());

  EXPECT_TRUE(comes_true([&] { return sut.odometry().counts().scans > before; }));
}

TEST_F(Live, GivesItsMapAndPosesAwayAndThenBeginsAnew) {
  const transport::HostClock clock;
  const Configuration configured = configuration();
  Pipeline sut(configured, clock);
  HealthMonitor health(configured, clock.now());
  sut.start();
  play(0, events_.size());
  ASSERT_TRUE(comes_true([&] { return sut.odometry().counts().scans >= 10; }));

  std::size_t points = 0;
  std::size_t far_away = 0;
  sut.want_map();
  EXPECT_TRUE(comes_true([&] {
    return sut.take_map([&](const Eigen::Vector3f& p_odom) {
      ++points;
      far_away += p_odom.norm() < 150.0F ? 0 : 1;
    });
  }));
  std::size_t poses = 0;
  sut.take_scan_poses([&](const ScanPose& pose) { poses += pose.epoch == 1 ? 1 : 0; });
  EXPECT_GT(points, 1000U);
  EXPECT_EQ(far_away, 0U);
  EXPECT_GE(poses, 10U);
  EXPECT_NE(health.read(sut, clock.now()).state, bus::State::kStarting);

  EXPECT_EQ(sut.begin_epoch(), 2U);
  EXPECT_EQ(health.read(sut, clock.now()).state, bus::State::kStarting);
}

TEST_F(Live, SurvivesGarbageOnAllPorts) {
  const transport::HostClock clock;
  Pipeline sut(configuration(), clock);
  sut.start();
  const Sensor sensor;
  std::uint32_t state = 1;
  std::uint64_t sent = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<std::byte> payload(1 + state % 1500);
    for (std::byte& byte : payload) {
      state = state * 1664525U + 1013904223U;
      byte = static_cast<std::byte>(state >> 24);
    }
    for (const int port : {kLidarPort, kPositionPort, kImuPort}) {
      sensor.send(payload, port);
    }
    ++sent;
    if (round % 16 == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  EXPECT_TRUE(comes_true([&] { return sut.receive().counts().lidar.dropped + sut.receive().counts().lidar.kernel_lost >= sent; }));
  EXPECT_EQ(sut.receive().counts().lidar.received, 0U);
  EXPECT_EQ(sut.odometry().counts().scans, 0U);
}

TEST_F(Live, TakesOnlyWhatTheDeviceSendsThatItIsToldOf) {
  const transport::HostClock clock;
  const Configuration configured = configuration();
  Rings rings(resolved_odometry(configured), 16, 16);
  ReceiveLoop sut(configured, clock, rings);
  const Sensor sensor;
  const auto packet =
      std::find_if(events_.begin(), events_.end(), [](const Event& event) { return event.port == kLidarPort; });
  const auto hear = [&] {  // what the device is counts after the loop has next shown its counts
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    sut.run_once(Duration{});
    sensor.send(packet->payload, kLidarPort);
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    sut.run_once(std::chrono::milliseconds(50));
    return sut.counts().lidar;
  };

  sut.set_device(0x7F000002);
  const SensorCounts others = hear();
  sut.set_device(0x7F000001);
  const SensorCounts its = hear();

  EXPECT_EQ(others.received, 0U);
  EXPECT_EQ(others.dropped, 1U);
  EXPECT_EQ(its.received, 1U);
  EXPECT_EQ(its.source_address, 0x7F000001U);
}

TEST_F(Live, NamesWhoHasThePort) {
  const transport::HostClock clock;
  const Pipeline first(configuration(), clock);

  try {
    const Pipeline second(configuration(), clock);
    FAIL() << "two pipelines share a port";
  } catch (const transport::TransportError& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(kLidarPort)), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("pid " + std::to_string(getpid())), std::string::npos) << error.what();
  }
}

// The loops without their threads, one after the other: so that this thread's allocations are all of theirs. LCM's own
// (memq allocates, udpm does not) are left out: publish has its own test in daemon/bus.
TEST_F(Live, DoesNotAllocateFromTheSocketToTheOdometry) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const transport::HostClock clock;
  const Configuration configured = configuration();
  const odometry::OdometryConfig odometry_config = resolved_odometry(configured);
  Rings rings(odometry_config, 512, 1024);
  ReceiveLoop receive(configured, clock, rings);
  PreprocessLoop preprocess(configured, odometry_config, clock, rings);
  OdometryLoop odometry(odometry_config, clock, rings);
  const Sensor sensor;
  const auto start = std::chrono::steady_clock::now();
  std::size_t allocations = 0;
  for (const Event& event : events_) {
    std::this_thread::sleep_until(start + (event.at - events_.front().at));
    sensor.send(event.payload, event.port);
    allocations += support::count_allocations([&] {
      receive.run_once(Duration{});
      preprocess.run_once(Duration{});
      odometry.run_once(Duration{});
    });
    while (auto job = rings.to_publish.try_pop()) {
      job->reset();
    }
    while (rings.imu_to_publish.try_pop()) {
    }
  }

  EXPECT_GT(odometry.counts().scans, 10U);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::pipeline
