#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "daemon/configuration/loader.hpp"
#include "daemon/pipeline/receive_loop.hpp"
#include "daemon/pipeline/serial_loop.hpp"
#include "drivers/imu/mip.hpp"
#include "drivers/imu/xsens.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::pipeline {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;
using imu::Protocol;

/// A sensor's end of a pseudo terminal, which a link leads to.
class Terminal {
 public:
  explicit Terminal(fs::path link) : link_(std::move(link)) { plug_in(); }
  ~Terminal() { unplug(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void plug_in() {
    char name[64];
    fd_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    SLAMD_ASSERT(fd_ >= 0 && grantpt(fd_) == 0 && unlockpt(fd_) == 0 && ptsname_r(fd_, name, sizeof name) == 0);
    name_ = name;
    fs::create_symlink(name_, link_);
  }

  void unplug() {
    fs::remove(link_);
    close(fd_);
    fd_ = -1;
  }

  /// Writes what there is room for; returns how much that was.
  std::size_t write(std::span<const std::byte> bytes) const {
    return static_cast<std::size_t>(std::max<ssize_t>(0, ::write(fd_, bytes.data(), bytes.size())));
  }

  /// Whether the host has read everything, whatever the kernel still carries included.
  bool is_drained() const {
    pollfd reader{open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK), POLLIN, 0};
    const bool empty = poll(&reader, 1, 0) == 0;
    close(reader.fd);
    return empty;
  }

 private:
  fs::path link_;
  std::string name_;
  int fd_ = -1;
};

/// The i-th sample of a sensor of 400 Hz.
Bytes sample_of(Protocol protocol, std::uint32_t i) {
  const auto copy = [](const auto& bytes) { return Bytes(bytes.begin(), bytes.end()); };
  if (protocol == Protocol::kXsens) {
    constexpr imu::XsensOutput kOutputs[] = {{imu::mt::kPacketCounter, 0}, {imu::mt::kSampleTimeFine, 0},
                                             {imu::mt::kAcceleration, 0}, {imu::mt::kRateOfTurn, 0}, {imu::mt::kStatusWord, 0}};
    return copy(write_sample(kOutputs, {static_cast<std::uint16_t>(i), 25 * i, {0.1, 0.2, 9.81}, {0.01 * (i % 7), 0.0, 0.3}}));
  }
  if (protocol == Protocol::kMip) {
    constexpr imu::MipOutput kOutputs[] = {{imu::mip::kReferenceTime}, {imu::mip::kDeltaReferenceTime},
                                           {imu::mip::kAcceleration}, {imu::mip::kTurnRate}};
    constexpr std::uint64_t kPeriod_ns = 2'500'000;
    return copy(write_sample(kOutputs, {(i + 1) * kPeriod_ns, kPeriod_ns, {0.1, 0.2, -9.81}, {0.01 * (i % 7), 0.0, 0.3}}));
  }
  char row[128];
  const int size = std::snprintf(row, sizeof row, "%u,0.01,0.%u,0.3,0.1,0.2,9.81\n", 2'500'000 * (i % 1000) + 1'000'000, i % 7);
  const auto bytes = std::as_bytes(std::span(row, static_cast<std::size_t>(size)));
  return {bytes.begin(), bytes.end()};
}

/// What looks like the beginning of a frame, or of a row, and is none.
Bytes garbage_of(Protocol protocol) {
  static const std::array<std::vector<int>, 3> kGarbage{
      {{'1', ',', 0xFF, 0, '\n'}, {0x00, 0xFA, 0x13, 0xFA, 0xFF, 0x36, 0x77, 0x55}, {0x00, 0x75, 0x75, 0x65, 0x75, 0x65, 0x01, 0x80}}};
  Bytes bytes;
  for (const int value : kGarbage[static_cast<std::size_t>(protocol)]) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

/// The receive loop and the serial loop, one after the other in this thread, so that its allocations are all theirs.
class Serial : public scratch::ScratchFolder {
 protected:
  void begin(const std::string& more) {
    fs::create_directories(folder_);
    configuration::Loader loader;
    loader.add_text("[[lidar]]\nmodel = \"vlp16\"\nport = 22468\nposition_port = 0\nbind_address = \"127.0.0.1\"\n[imu]\nsource = "
                    "\"serial\"\ndevice = \"" + (folder_ / "imu").string() + "\"\n" + more, "test.toml");
    const configuration::Configuration configuration = loader.load();
    odometry::OdometryConfig odometry = resolved_odometry(configuration);
    odometry.preprocess.max_points = 1000;
    rings_ = std::make_unique<Rings>(odometry, 4, 1024);
    receive_ = std::make_unique<ReceiveLoop>(configuration, clock_, *rings_);
    serial_ = std::make_unique<SerialLoop>(configuration, clock_, *receive_->serial_line());
  }

  void serve() {
    allocations_ += support::count_allocations([&] {
      serial_->run_once(Duration{});
      receive_->run_once(Duration{});
    });
    while (rings_->imu_to_publish.try_pop()) {
    }
    while (const auto arrival = rings_->imu_to_preprocess.try_pop()) {
      EXPECT_GE(arrival->sample.stamp, newest_);
      newest_ = arrival->sample.stamp;
      ++samples_;
    }
    while (const auto record = serial_->events().try_read()) {
      events_.push_back(record->event);
    }
  }

  template <typename Condition>
  bool comes_true(Condition&& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition() && std::chrono::steady_clock::now() < deadline) {
      serve();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return condition();
  }

  bool happens(threads::Event event) {
    return comes_true([&] { return std::find(events_.begin(), events_.end(), event) != events_.end(); });
  }

  void drain(const Terminal& sensor) {
    ASSERT_TRUE(comes_true([&] { return sensor.is_drained(); }));
    serve();
  }

  /// Writes bytes in pieces of any size: some samples are split, others merged.
  void send(const Terminal& sensor, const Bytes& bytes) {
    stream_.insert(stream_.end(), bytes.begin(), bytes.end());
    std::uniform_int_distribution<std::size_t> size(1, 300);
    while (stream_.size() > 300) {
      const std::size_t written = sensor.write(std::span(stream_).first(size(random_)));
      stream_.erase(stream_.begin(), stream_.begin() + static_cast<std::ptrdiff_t>(written));
      serve();
    }
  }

  void flush(const Terminal& sensor) {
    while (!stream_.empty()) {
      const std::size_t written = sensor.write(stream_);
      stream_.erase(stream_.begin(), stream_.begin() + static_cast<std::ptrdiff_t>(written));
      serve();
    }
    drain(sensor);
  }

  transport::HostClock clock_;
  std::unique_ptr<Rings> rings_;
  std::unique_ptr<ReceiveLoop> receive_;
  std::unique_ptr<SerialLoop> serial_;
  std::mt19937 random_{7};
  Bytes stream_;
  std::size_t samples_ = 0;
  std::size_t allocations_ = 0;
  Stamp newest_{};
  std::vector<threads::Event> events_;
};

class SerialStream : public Serial, public testing::WithParamInterface<Protocol> {};

// Split, merged, damaged, cut off, between garbage, stalled, hung up and plugged in again.
TEST_P(SerialStream, LosesExactlyTheSamplesThatAreDamaged) {
  const Protocol protocol = GetParam();
  begin(std::string("baud = 921600\nclock = \"shared\"\nprotocol = \"") + name_of(protocol) + "\"\n");
  Terminal sensor(folder_ / "imu");
  ASSERT_TRUE(happens(threads::Event::kSerialOpen));
  allocations_ = 0;
  if (protocol == Protocol::kCsv) {
    send(sensor, Bytes{std::byte{'\n'}});
  }
  std::size_t sent = 0;
  std::size_t damaged = 0;

  for (std::uint32_t i = 0; i < 1000; ++i, ++sent) {
    Bytes sample = sample_of(protocol, i);
    if (i % 10 == 3) {
      sample[sample.size() / 2] ^= std::byte{0x40};
      ++damaged;
    } else if (i % 10 == 6) {
      sample.resize(sample.size() / 3);  // cut off
      if (protocol == Protocol::kCsv) {
        sample.push_back(std::byte{'\n'});
      }
      ++damaged;
    } else if (i % 10 == 8) {
      send(sensor, garbage_of(protocol));
    }
    if (i == 500) {
      flush(sensor);
      std::this_thread::sleep_for(std::chrono::milliseconds(30));  // stalled
    }
    if (i == 709) {  // hung up in the middle of a sample, right behind garbage that announces more
      const auto half = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
      send(sensor, {sample.begin(), half});
      flush(sensor);
      sensor.unplug();
      ASSERT_TRUE(happens(threads::Event::kSerialLost));
      events_.clear();
      sensor.plug_in();
      ASSERT_TRUE(happens(threads::Event::kSerialOpen));
      send(sensor, {half, sample.end()});
      ++damaged;
      continue;
    }
    send(sensor, sample);
  }
  flush(sensor);
  sensor.unplug();
  ASSERT_TRUE(happens(threads::Event::kSerialLost));

  EXPECT_EQ(samples_, sent - damaged);
  EXPECT_EQ(damaged, 201U);
  if (support::allocation_guard_available()) {
    EXPECT_EQ(allocations_, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(EachProtocol, SerialStream, testing::Values(Protocol::kCsv, Protocol::kXsens, Protocol::kMip),
                         [](const auto& protocol) { return std::string(name_of(protocol.param)); });

TEST_F(Serial, SaysOnceThatThereIsNoPortAndTakesItWhenItComes) {
  begin("");
  ASSERT_TRUE(happens(threads::Event::kSerialRefused));
  Terminal sensor(folder_ / "imu");

  EXPECT_TRUE(happens(threads::Event::kSerialOpen));

  EXPECT_EQ(std::count(events_.begin(), events_.end(), threads::Event::kSerialRefused), 1);
}

TEST_F(Serial, HandsThePortFromThreadToThreadAsOftenAsItIsPluggedIn) {
  begin("baud = 921600\n");
  std::atomic<bool> stopping{false};
  std::thread serial([&] {
    while (!stopping) {
      serial_->run_once(std::chrono::milliseconds(5));
    }
  });
  const auto samples_come = [&](const Terminal& sensor, std::uint32_t begin) {
    const std::uint64_t before = receive_->counts().imu.received;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    for (std::uint32_t i = begin; receive_->counts().imu.received < before + 10; ++i) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      sensor.write(sample_of(Protocol::kCsv, i));
      receive_->run_once(std::chrono::milliseconds(5));
    }
    return true;
  };

  for (std::uint32_t round = 0; round < 3; ++round) {
    const Terminal sensor(folder_ / "imu");
    EXPECT_TRUE(samples_come(sensor, 1 + 300 * round));
  }

  stopping = true;
  serial.join();
}

TEST_F(Serial, SeesThatForceComesInG) {
  begin("baud = 115200\n");
  Terminal sensor(folder_ / "imu");
  ASSERT_TRUE(happens(threads::Event::kSerialOpen));

  for (int i = 0; i < 120; ++i) {
    char row[64];
    const int size = std::snprintf(row, sizeof row, "\n%d0000000,0,0,0,0,0,0.998\n", i + 1);
    const auto bytes = std::as_bytes(std::span(row, static_cast<std::size_t>(size)));
    send(sensor, {bytes.begin(), bytes.end()});
  }
  flush(sensor);

  EXPECT_TRUE(comes_true([&] { return receive_->counts().imu_units == imu::Units::kInG; }));
}

}  // namespace
}  // namespace slamd::pipeline
