#include "drivers/transport/serial_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
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

  std::string read() const {
    char text[64];
    const ssize_t size = ::read(fd_, text, sizeof text);
    return {text, static_cast<std::size_t>(std::max<ssize_t>(0, size))};
  }

  /// The rate that is set, as termios has it.
  unsigned speed() const {
    termios mode{};
    SLAMD_ASSERT(tcgetattr(fd_, &mode) == 0);
    return cfgetispeed(&mode);
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

TEST(SerialPort, SaysThatTheDeviceIsUnplugged) {
  Device device;
  SerialPort sut({device.name()});
  ASSERT_EQ(sut.open(), 0);
  device.unplug();

  EXPECT_FALSE(sut.is_gone());
  EXPECT_TRUE(sut.read().empty());

  EXPECT_TRUE(sut.is_gone());
  EXPECT_TRUE(sut.read().empty());
  EXPECT_EQ(sut.write(std::as_bytes(std::span("x", 1))), 0U);
  sut.close();
  EXPECT_FALSE(sut.is_open());
  EXPECT_FALSE(sut.is_gone());
  EXPECT_EQ(sut.fd(), -1);
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

TEST(SerialPort, WritesToTheDevice) {
  Device device;
  SerialPort sut({device.name()});
  ASSERT_EQ(sut.open(), 0);
  const std::string command = "\xFA\xFF\x30\n\r\x11";

  EXPECT_EQ(sut.write(std::as_bytes(std::span(command))), command.size());

  EXPECT_EQ(device.read(), command);
}

TEST(SerialPort, ChangesItsRateOpenOrClosed) {
  Device device;
  SerialPort sut({device.name(), 9'600});
  EXPECT_EQ(sut.set_baud(115'200), 0);
  ASSERT_EQ(sut.open(), 0);
  EXPECT_EQ(device.speed(), static_cast<unsigned>(B115200));
  device.write("of the old rate");

  EXPECT_EQ(sut.set_baud(921'600), 0);

  EXPECT_EQ(sut.baud(), 921'600);
  EXPECT_EQ(device.speed(), static_cast<unsigned>(B921600));
  EXPECT_TRUE(sut.read().empty());
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
