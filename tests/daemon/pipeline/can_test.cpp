#include <linux/can.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "daemon/configuration/loader.hpp"
#include "daemon/pipeline/health_monitor.hpp"
#include "daemon/pipeline/preprocess_loop.hpp"
#include "daemon/pipeline/receive_loop.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::pipeline {
namespace {

constexpr const char* kInterface = "slamd_bus";
constexpr const char* kOnCan =
    "[imu]\nsource = \"can\"\ninterface = \"slamd_bus\"\nprotocol = \"xsens\"\n[wheel]\nsource = \"can\"\ninterface = \"slamd_bus\"\n"
    "left = { id = 0x1A0, signed = true, scale = 0.001 }\nright = { id = 0x1A0, first_bit = 16, signed = true, scale = 0.001 }\n";

configuration::Configuration configured(const std::string& more) {
  configuration::Loader loader;
  loader.add_text("[[lidar]]\nmodel = \"vlp16\"\nport = 22568\nposition_port = 0\nbind_address = \"127.0.0.1\"\n" + more, "test.toml");
  return loader.load();
}

class CanReceive : public testing::Test {
 protected:
  void begin(const std::string& more) {
    configuration_ = configured(more);
    odometry_ = resolved_odometry(configuration_);
    odometry_.preprocess.max_points = 1000;
    rings_ = std::make_unique<Rings>(odometry_, 4, 1024);
    sut_ = std::make_unique<ReceiveLoop>(configuration_, clock_, *rings_);
  }

  transport::HostClock clock_;
  configuration::Configuration configuration_;
  odometry::OdometryConfig odometry_;
  std::unique_ptr<Rings> rings_;
  std::unique_ptr<ReceiveLoop> sut_;
};

TEST_F(CanReceive, RefusesWheelsThatAreAFile) {
  EXPECT_EQ(scratch::message_of<configuration::ConfigurationError>([&] { begin("[wheel]\nsource = \"odom.csv\"\n"); }),
            "wheel.source = \"odom.csv\": a file is for slamd-replay; slamd takes can (or none: wheel.use = false)");
}

TEST_F(CanReceive, SaysThatTheKernelHasNoCan) {
  const int probe = socket(PF_CAN, SOCK_RAW, 1);
  if (probe >= 0) {
    close(probe);
    GTEST_SKIP() << "this kernel has CAN";
  }

  const std::string said = scratch::message_of<transport::TransportError>([&] { begin(kOnCan); });

  EXPECT_EQ(said.rfind("CAN interface slamd_bus: this kernel has no CAN", 0), 0U) << said;
}

TEST_F(CanReceive, HasNoBusWhereNothingIsOnOne) {
  begin("[imu]\nsource = \"udp\"\nport = 27601\n[wheel]\nuse = false\nsource = \"odom.csv\"\n");

  EXPECT_EQ(sut_->can(), nullptr);
  EXPECT_TRUE(sut_->wheels().empty() && sut_->can_frames().empty());
}

TEST_F(CanReceive, HandsWheelsToPreprocess) {
  begin("");
  PreprocessLoop preprocess(configuration_, odometry_, clock_, *rings_);
  rings_->wheels_to_preprocess.try_push({clock_.now(), 1.0, 0.1});

  preprocess.run_once(Duration{});

  EXPECT_FALSE(rings_->wheels_to_preprocess.try_pop());
}

TEST(CanEvents, AreToldWithTheirInterface) {
  const threads::EventRecord record{Stamp{}, threads::Event::kCanBusOff, if_nametoindex("lo")};

  EXPECT_EQ(sentence(record).rfind("lo: bus off", 0), 0U) << sentence(record);
  EXPECT_EQ(sentence({Stamp{}, threads::Event::kCanRestarted, 99'999}), "CAN interface 99999: restarted, on the bus again");
  EXPECT_NE(cause_of(record), cause_of({Stamp{}, threads::Event::kCanBusOff, 99'999}));
}

/// On a kernel that has CAN: tests/system/can.sh runs these under user-mode Linux.
class CanLoop : public CanReceive {
 protected:
  void SetUp() override {
    const std::string name(kInterface);
    if (std::system(("{ ip link add dev " + name + " type vcan && ip link set " + name + " up; } 2>/dev/null").c_str()) != 0) {
      GTEST_SKIP() << "no vcan here (tests/system/can.sh runs this under user-mode Linux)";
    }
    fd_ = socket(PF_CAN, SOCK_RAW, 1);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(kInterface));
    SLAMD_ASSERT(bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    begin(kOnCan);
  }

  void TearDown() override {
    close(fd_);
    std::system((std::string("ip link del ") + kInterface + " 2>/dev/null").c_str());
  }

  void send(std::uint32_t can_id, std::initializer_list<int> data) const {
    can_frame raw{};
    raw.can_id = can_id;
    raw.can_dlc = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), raw.data);
    SLAMD_ASSERT(write(fd_, &raw, sizeof raw) == static_cast<ssize_t>(sizeof raw));
  }

  int fd_ = -1;
};

TEST_F(CanLoop, HandsSamplesOnAndTellsWhatHappensWithoutAllocating) {
  for (int i = 0; i < 20; ++i) {
    send(0x005, {0, 0, 0, 10 * i});
    send(0x032, {0, 5, 0xFF, 0xF6, 1, 0});
    send(0x034, {0, 0x0D, 0xFF, 0xE1, 9, 0xCF});
    send(0x1A0, {0xE8, 3, 0xDC, 5});
    send(0x7FF, {1});
  }
  send(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
  std::size_t allocations = 0;
  std::size_t samples = 0;
  std::size_t wheels = 0;
  bool told = false;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);

  while ((samples < 20 || wheels < 20 || !told) && std::chrono::steady_clock::now() < deadline) {
    allocations += support::count_allocations([&] { sut_->run_once(std::chrono::milliseconds(10)); });
    while (const auto arrival = rings_->imu_to_preprocess.try_pop()) {
      EXPECT_EQ(arrival->sample.angular_rate_radps.z(), 0.5);
      ++samples;
    }
    while (const auto sample = rings_->wheels_to_preprocess.try_pop()) {
      EXPECT_DOUBLE_EQ(sample->speed_mps, 1.25);
      ++wheels;
    }
    while (const auto record = sut_->events().try_read()) {
      told = told || sentence(*record).rfind("slamd_bus: bus off", 0) == 0;
    }
  }

  EXPECT_EQ(samples, 20U);
  EXPECT_EQ(wheels, 20U);
  EXPECT_TRUE(told);
  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(sut_->counts().wheels.received, 20U);
}

}  // namespace
}  // namespace slamd::pipeline
