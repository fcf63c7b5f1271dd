// What only a kernel with CAN can show; tests/system/can.sh runs these under user-mode Linux, as root.
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/tty.h>
#include <net/if.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "drivers/transport/can_socket.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::transport {
namespace {

constexpr const char* kInterface = "slamd_can";

bool run(const std::string& command) { return std::system((command + " 2>/dev/null").c_str()) == 0; }

/// Somebody else on the bus.
class Sender {
 public:
  explicit Sender(const char* interface = kInterface) : fd_(socket(PF_CAN, SOCK_RAW, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface));
    SLAMD_ASSERT(bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
  }
  ~Sender() { close(fd_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void send(std::uint32_t can_id, std::uint8_t first = 0, std::uint8_t second = 0) const {
    can_frame raw{};
    raw.can_id = can_id;
    raw.can_dlc = 8;
    raw.data[0] = first;
    raw.data[1] = second;
    while (write(fd_, &raw, sizeof raw) != static_cast<ssize_t>(sizeof raw)) {
      SLAMD_ASSERT(errno == ENOBUFS);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

 private:
  int fd_;
};

/// Tries for a while: what is written to a bus arrives a little later.
template <typename Condition>
bool comes_true(Condition&& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!condition() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

class CanKernel : public testing::Test {
 protected:
  void SetUp() override {
    run(std::string("ip link del ") + kInterface);
    if (!add()) {
      GTEST_SKIP() << "no vcan here (tests/system/can.sh runs this under user-mode Linux)";
    }
  }

  void TearDown() override { run(std::string("ip link del ") + kInterface); }

  static bool add() {
    const std::string name(kInterface);
    return run("ip link add dev " + name + " type vcan && ip link set " + name + " up");
  }

  void open(const CanSocketConfig& config) {
    sut_ = std::make_unique<CanSocket>(config, clock_);
    link_ = sut_->attend();
  }

  /// Takes what is there.
  void take() {
    while (sut_->receive([&](const CanFrame& frame) { frames_.push_back(frame); }) > 0) {
    }
  }

  bool receives(std::size_t count) {
    return comes_true([&] {
      take();
      return frames_.size() >= count;
    });
  }

  HostClock clock_;
  CanLink link_ = CanLink::kUnknown;
  std::unique_ptr<CanSocket> sut_;
  std::vector<CanFrame> frames_;
};

TEST_F(CanKernel, ReceivesWhatPassesTheFiltersAndStampsIt) {
  open({kInterface, {{.id = 0x032}, {0x0CF02A00, 0x03FF'FF00, true}}});
  const Sender sender;
  const Stamp before = clock_.now();

  for (std::uint8_t i = 0; i < 100; ++i) {
    sender.send(0x032, i);
    sender.send(0x033, i);                           // another
    sender.send(0x032U | CAN_EFF_FLAG, i);           // long
    sender.send(0x032U | CAN_RTR_FLAG, i);           // asks
    sender.send(0x18F02A93U | CAN_EFF_FLAG, i);      // whatever the priority and the source
    sender.send(0x18F02B93U | CAN_EFF_FLAG, i);
  }

  ASSERT_EQ(link_, CanLink::kUp);
  ASSERT_TRUE(receives(200));
  EXPECT_EQ(frames_.size(), 200U);
  EXPECT_EQ(frames_[0].id, 0x032U);
  EXPECT_EQ(frames_[199].id, 0x18F02A93U);
  EXPECT_EQ(frames_[199].data[0], std::byte{99});
  EXPECT_GE(frames_[0].received, before - std::chrono::milliseconds(1));
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    EXPECT_LE(frames_[i - 1].received, frames_[i].received);
  }
}

TEST_F(CanKernel, CountsExactlyWhatTheKernelLoses) {
  constexpr std::uint64_t kSent = 500;
  open({kInterface, {}, 1});  // the smallest that the kernel gives
  const Sender sender;

  for (std::uint64_t i = 0; i < kSent; ++i) {
    sender.send(0x100);
  }

  EXPECT_TRUE(comes_true([&] {
    take();
    return sut_->counters().received + sut_->counters().kernel_lost >= kSent;
  }));
  EXPECT_EQ(sut_->counters().received + sut_->counters().kernel_lost, kSent);
  EXPECT_GT(sut_->counters().kernel_lost, 0U);
  sender.send(0x101);
  EXPECT_TRUE(receives(sut_->counters().received + 1));
  EXPECT_EQ(sut_->counters().received + sut_->counters().kernel_lost, kSent + 1);
}

TEST_F(CanKernel, CountsErrorFramesThoughNoFilterWantsThem) {
  open({kInterface, {{.id = 0x032}}});
  const Sender sender;

  sender.send(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  sender.send(CAN_ERR_FLAG | CAN_ERR_RESTARTED);
  sender.send(CAN_ERR_FLAG | CAN_ERR_CRTL, 0, CAN_ERR_CRTL_RX_OVERFLOW);
  sender.send(0x032);

  ASSERT_TRUE(receives(1));
  EXPECT_EQ(sut_->counters().bus_off, 1U);
  EXPECT_EQ(sut_->counters().restarted, 1U);
  EXPECT_EQ(sut_->counters().controller_lost, 1U);
}

TEST_F(CanKernel, SurvivesThatTheInterfaceGoesDownAndAwayAndComesBack) {
  const std::string name(kInterface);
  open({kInterface, {}});
  const int fd = sut_->fd();
  Sender(kInterface).send(1);
  ASSERT_TRUE(receives(1));

  ASSERT_TRUE(run("ip link set " + name + " down"));
  take();
  EXPECT_EQ(sut_->attend(), CanLink::kDown);
  ASSERT_TRUE(run("ip link set " + name + " up"));
  EXPECT_EQ(sut_->attend(), CanLink::kUp);
  Sender(kInterface).send(2);
  EXPECT_TRUE(receives(2));

  ASSERT_TRUE(run("ip link del " + name));
  take();
  EXPECT_EQ(sut_->attend(), CanLink::kAbsent);
  ASSERT_TRUE(add());
  EXPECT_EQ(sut_->attend(), CanLink::kUp);
  Sender(kInterface).send(3);
  EXPECT_TRUE(receives(3));
  EXPECT_EQ(frames_[2].id, 3U);
  EXPECT_EQ(sut_->fd(), fd);
}

TEST_F(CanKernel, WaitsForAnInterfaceThatIsNotThereYet) {
  run(std::string("ip link del ") + kInterface);
  open({kInterface, {}});
  EXPECT_EQ(link_, CanLink::kAbsent);

  ASSERT_TRUE(add());

  EXPECT_EQ(sut_->attend(), CanLink::kUp);
  Sender(kInterface).send(1);
  EXPECT_TRUE(receives(1));
}

TEST_F(CanKernel, TellsAnInterfaceThatIsNoneOfCan) {
  open({"lo", {}});

  EXPECT_EQ(link_, CanLink::kNotCan);
}

TEST_F(CanKernel, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  open({kInterface, {}});
  Sender(kInterface).send(1);
  std::size_t seen = 0;
  std::size_t allocations = 0;

  EXPECT_TRUE(comes_true([&] {
    allocations += support::count_allocations([&] { sut_->receive([&](const CanFrame& frame) { seen += frame.size; }); });
    return seen > 0;
  }));

  EXPECT_EQ(allocations, 0U);
}

TEST_F(CanKernel, ReceivesFromAnAdapterOnASerialLine) {
  char terminal[64];
  const int adapter = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_TRUE(adapter >= 0 && grantpt(adapter) == 0 && unlockpt(adapter) == 0 && ptsname_r(adapter, terminal, sizeof terminal) == 0);
  const int line = ::open(terminal, O_RDWR | O_NOCTTY);
  termios mode{};
  tcgetattr(line, &mode);
  cfmakeraw(&mode);
  cfsetspeed(&mode, B921600);
  tcsetattr(line, TCSANOW, &mode);
  int discipline = N_SLCAN;
  ASSERT_EQ(ioctl(line, TIOCSETD, &discipline), 0);
  ifreq request{};
  ASSERT_EQ(ioctl(line, SIOCGIFNAME, request.ifr_name), 0);
  const std::string interface = request.ifr_name;
  ASSERT_TRUE(run("ip link set " + interface + " up"));
  open({interface, {}});

  const std::string bytes = "t03260005FFF60100\rT08F02D8080C7DDE7C2B790002\r";
  ASSERT_EQ(write(adapter, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));

  EXPECT_EQ(link_, CanLink::kUp);
  ASSERT_TRUE(receives(2));
  EXPECT_EQ(frames_[0].id, 0x032U);
  EXPECT_EQ(frames_[0].size, 6U);
  EXPECT_EQ(frames_[0].data[1], std::byte{0x05});
  EXPECT_EQ(frames_[1].id, 0x08F02D80U);
  EXPECT_TRUE(frames_[1].is_extended);
  close(line);
  close(adapter);
  EXPECT_TRUE(comes_true([&] { return sut_->attend() == CanLink::kAbsent; }));
}

}  // namespace
}  // namespace slamd::transport
