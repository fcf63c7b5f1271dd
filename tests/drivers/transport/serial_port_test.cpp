#include "drivers/transport/serial_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "drivers/transport/transport_error.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::transport {
namespace {

/// The far end of a pseudo terminal.
class Device {
 public:
  Device() : fd_(posix_openpt(O_RDWR | O_NOCTTY)) {
    SLAMD_ASSERT(fd_ >= 0 && grantpt(fd_) == 0 && unlockpt(fd_) == 0);
    char name[64];
    SLAMD_ASSERT(ptsname_r(fd_, name, sizeof name) == 0);
    name_ = name;
  }
  ~Device() { unplug(); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const std::string& name() const { return name_; }
  void write(const std::string& text) { SLAMD_ASSERT(::write(fd_, text.data(), text.size()) == static_cast<ssize_t>(text.size())); }

  void unplug() {
    if (fd_ >= 0) {
      close(fd_);
      fd_ = -1;
    }
  }

  bool has_echo() const {
    pollfd waiting{fd_, POLLIN, 0};
    return poll(&waiting, 1, 20) > 0;
  }

 private:
  int fd_;
  std::string name_;
};

/// What comes in within a moment.
std::string text_from(SerialPort& port) {
  pollfd waiting{port.fd(), POLLIN, 0};
  poll(&waiting, 1, 1000);
  const auto bytes = port.read();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(SerialPort, HandsOutTheBytesAsTheyCome) {
  Device device;
  SerialPort sut({device.name()});
  ASSERT_EQ(sut.open(), 0);

  const std::string bytes = "a\r\n\x03\x11\x13\x1A\xFF\x04 z";  // a cooked terminal would eat most of these
  device.write(bytes);

  EXPECT_EQ(text_from(sut), bytes);
  EXPECT_FALSE(device.has_echo());
}

TEST(SerialPort, ReturnsNothingAndStaysOpenWhenNothingWaits) {
  Device device;
  SerialPort sut({device.name()});
  ASSERT_EQ(sut.open(), 0);

  EXPECT_TRUE(sut.read().empty());
  EXPECT_TRUE(sut.is_open());
}

TEST(SerialPort, ClosesWhenTheDeviceIsUnplugged) {
  Device device;
  SerialPort sut({device.name()});
  ASSERT_EQ(sut.open(), 0);
  device.unplug();

  EXPECT_TRUE(sut.read().empty());

  EXPECT_FALSE(sut.is_open());
  EXPECT_EQ(sut.fd(), -1);
  EXPECT_TRUE(sut.read().empty());
}

TEST(SerialPort, OpensAgainWhenTheDeviceIsBack) {
  Device first, second;
  const std::string link = testing::TempDir() + "slamd_serial_" + std::to_string(getpid());
  unlink(link.c_str());
  ASSERT_EQ(symlink(first.name().c_str(), link.c_str()), 0);
  SerialPort sut({link});
  ASSERT_EQ(sut.open(), 0);
  first.unplug();
  sut.read();
  unlink(link.c_str());
  EXPECT_EQ(sut.open(), ENOENT);

  ASSERT_EQ(symlink(second.name().c_str(), link.c_str()), 0);
  ASSERT_EQ(sut.open(), 0);
  second.write("back");

  EXPECT_EQ(text_from(sut), "back");
  unlink(link.c_str());
}

TEST(SerialPort, SaysWhyItCannotBeOpened) {
  SerialPort absent({"/dev/slamd-none"});
  EXPECT_EQ(absent.explain(absent.open()), "serial port /dev/slamd-none: not there (No such file or directory)");

  SerialPort no_terminal({"/dev/null"});
  EXPECT_EQ(no_terminal.explain(no_terminal.open()), "serial port /dev/null: is no serial port");
  EXPECT_FALSE(no_terminal.is_open());
}

TEST(SerialPort, RefusesARateThatIsNone) {
  EXPECT_THROW(SerialPort({"/dev/null", 123'456}), TransportError);
  EXPECT_TRUE(SerialPort::is_standard_rate(115'200));
  EXPECT_FALSE(SerialPort::is_standard_rate(0));
}

TEST(SerialPort, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Device device;
  SerialPort sut({device.name()});

  const std::size_t allocations = support::count_allocations([&] {
    ASSERT_EQ(sut.open(), 0);
    sut.read();
    device.unplug();
    sut.read();
    EXPECT_NE(sut.open(), 0);
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::transport
