#include "tools/sensors/places.hpp"

#include <cstdlib>
#include <thread>

#include <csignal>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "made_bytes.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/sensors/bus_place.hpp"
#include "tools/sensors/serial_place.hpp"
#include "tools/sensors/udp_place.hpp"

namespace slamd::sensors {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Places : public scratch::ScratchFolder {};

TEST_F(Places, NameAdaptersByTheLinksThatStay) {
  for (const char* name : {"ttyUSB0", "ttyUSB1", "ttyACM0", "ttyS0", "ttyAMA0", "null"}) {
    write(name, "");
  }
  std::filesystem::create_directories(folder_ / "serial" / "by-id");
  std::filesystem::create_symlink("../../ttyUSB1", folder_ / "serial" / "by-id" / "usb-Xsens");
  std::filesystem::create_symlink("../../gone", folder_ / "serial" / "by-id" / "usb-gone");

  EXPECT_THAT(serial_adapters(folder_), ElementsAre((folder_ / "serial/by-id/usb-Xsens").string(), (folder_ / "ttyACM0").string(),
                                                    (folder_ / "ttyUSB0").string()));
}

TEST_F(Places, KnowADeviceByEachOfItsNames) {
  const std::string device = write("ttyUSB0", "").string();
  const std::string other = write("ttyUSB1", "").string();
  const std::string link = (folder_ / "imu").string();
  std::filesystem::create_symlink("ttyUSB0", link);

  EXPECT_TRUE(is_same_device(link, device));
  EXPECT_FALSE(is_same_device(link, other));
  EXPECT_TRUE(is_same_device("/nowhere/tty", "/nowhere/tty"));
  EXPECT_FALSE(is_same_device("/nowhere/tty", "/nowhere/other"));
}

TEST_F(Places, NameCanInterfacesByTheirType) {
  write("eth0/type", "1\n");
  write("can0/type", "280\n");
  write("vcan0/type", "280\n");
  write("broken/other", "");

  EXPECT_THAT(can_interfaces(folder_), ElementsAre("can0", "vcan0"));
  EXPECT_TRUE(can_interfaces(folder_ / "none").empty());
}

TEST(UdpPlace, SaysWhoHasItsPortAndTakesItWhenItIsFree) {
  const transport::HostClock clock;
  auto owner = std::make_unique<transport::DatagramSocket>(0);
  UdpPlace sut(owner->port(), "points", UdpPlace::Kind::kData, clock);
  EXPECT_FALSE(sut.is_open());
  EXPECT_THAT(sut.seen().owner, HasSubstr("(pid " + std::to_string(getpid()) + ")"));

  owner.reset();
  sut.attend();

  EXPECT_TRUE(sut.is_open());
  EXPECT_EQ(sut.seen().owner, "");
}

TEST(UdpPlace, LeavesAnswersToWhoeverWaitsForThem) {
  const transport::HostClock clock;
  const transport::DatagramSocket owner(0, transport::DatagramSocket::Sharing::kWithOthers);

  const UdpPlace answers(owner.port(), "answers", UdpPlace::Kind::kAnswers, clock);
  const UdpPlace broadcasts(owner.port(), "broadcasts", UdpPlace::Kind::kBroadcasts, clock);

  EXPECT_FALSE(answers.is_open());
  EXPECT_TRUE(broadcasts.is_open());
}

TEST(UdpPlace, HandsOnWhatComesAndCountsStrangers) {
  const transport::HostClock clock;
  std::uint16_t port = 0;
  {
    port = transport::DatagramSocket(0).port();
  }
  UdpPlace sut(port, "points", UdpPlace::Kind::kData, clock);
  transport::DatagramSocket sender(0);
  NetworkWatch network;

  sender.send(velodyne_packet(), 0x7F000001, port);
  sender.send(text_bytes("hello"), 0x7F000001, port);
  sut.run_once(network, kInterfaces);
  sut.end_second();

  EXPECT_EQ(sut.seen().datagrams, (Count{2, 2}));
  EXPECT_EQ(sut.seen().strange, (Count{1, 1}));
  EXPECT_EQ(sut.seen().stranger, 0x7F000001U);
  Seen seen;
  network.show(clock.now(), seen);
  EXPECT_EQ(seen.lidars.size(), 1U);
}

class Terminal : public testing::Test {
 protected:
  Terminal() : fd_(posix_openpt(O_RDWR | O_NOCTTY)) {
    grantpt(fd_);
    unlockpt(fd_);
    name_ = ptsname(fd_);
  }
  ~Terminal() override { close(fd_); }

  int fd_;
  std::string name_;
};

TEST_F(Terminal, IsListenedTo) {
  SerialPlace sut(name_, false, kBegin);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const Bytes bytes = xsens_message(100 * i);
    ASSERT_EQ(write(fd_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }

  sut.run_once(kBegin + std::chrono::milliseconds(10));

  EXPECT_EQ(sut.seen().tongue, Tongue::kXsens);
  EXPECT_EQ(sut.seen().imu.samples.total, 20U);
  EXPECT_EQ(sut.seen().trouble, "");
}

TEST_F(Terminal, HearsNoQuestionUnlessItMayBeAsked) {
  SerialPlace quiet(name_, false, kBegin);
  quiet.run_once(kBegin + std::chrono::milliseconds(400));
  fcntl(fd_, F_SETFL, O_NONBLOCK);
  char byte = 0;
  EXPECT_EQ(read(fd_, &byte, 1), -1);

  SerialPlace asking(name_, true, kBegin);
  asking.run_once(kBegin + std::chrono::milliseconds(400));

  EXPECT_EQ(read(fd_, &byte, 1), 1);
}

TEST_F(Terminal, SaysWhenItIsUnpluggedAndWhenItIsNotThere) {
  SerialPlace sut(name_, false, kBegin);
  close(fd_);
  sut.run_once(kBegin + std::chrono::milliseconds(10));
  EXPECT_EQ(sut.seen().trouble, "was unplugged");

  const SerialPlace absent("/nowhere/tty", false, kBegin);
  EXPECT_THAT(absent.seen().trouble, HasSubstr("not there"));
}

TEST_F(Terminal, IsLeftToWhoeverComesLater) {
  SerialPlace sut(name_, false, kBegin);
  sut.run_once(kBegin);
  EXPECT_GE(sut.fd(), 0);
  int opened[2];
  ASSERT_EQ(pipe(opened), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(sut.fd());
    const int fd = open(name_.c_str(), O_RDWR | O_NOCTTY);
    (void)!write(opened[1], &fd, 1);
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(opened[0], &byte, 1), 1);

  sut.run_once(kBegin + SerialPlace::kRetry);
  const LineSeen left = sut.seen();
  const int fd = sut.fd();
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  sut.run_once(kBegin + 2 * SerialPlace::kRetry);

  EXPECT_THAT(left.trouble, HasSubstr("is held by test_tools"));
  EXPECT_THAT(left.trouble, HasSubstr("(pid " + std::to_string(child) + "), and left to it"));
  EXPECT_EQ(fd, -1);
  EXPECT_EQ(sut.seen().trouble, "");
  EXPECT_GE(sut.fd(), 0);
  close(opened[0]);
  close(opened[1]);
}

TEST(BusPlace, SaysWhatIsTheMatterWithItsInterface) {
  const BusPlace sut("slamd_none", transport::HostClock{});

  EXPECT_EQ(sut.seen().interface, "slamd_none");
  EXPECT_NE(sut.seen().trouble, "");
}

}  // namespace
}  // namespace slamd::sensors
