#include "drivers/transport/serial_port.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "core/base/assert.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {

namespace {

/// The termios constant of a rate; B0 for none.
speed_t speed_of(int baud) {
  switch (baud) {
    case 4800: return B4800;
    case 9600: return B9600;
    case 19'200: return B19200;
    case 38'400: return B38400;
    case 57'600: return B57600;
    case 115'200: return B115200;
    case 230'400: return B230400;
    case 460'800: return B460800;
    case 500'000: return B500000;
    case 576'000: return B576000;
    case 921'600: return B921600;
    case 1'000'000: return B1000000;
    case 1'152'000: return B1152000;
    case 1'500'000: return B1500000;
    case 2'000'000: return B2000000;
    case 2'500'000: return B2500000;
    case 3'000'000: return B3000000;
    case 3'500'000: return B3500000;
    case 4'000'000: return B4000000;
    default: return B0;
  }
}

/// Raw, eight bits, no flow control. Returns 0 or an errno.
int make_raw(int fd, speed_t speed) {
  termios mode{};
  if (tcgetattr(fd, &mode) != 0) {
    return errno;
  }
  cfmakeraw(&mode);
  mode.c_cflag |= CLOCAL | CREAD;
  mode.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
  mode.c_cc[VMIN] = 1;  // with 0, "nothing waits" would look like "unplugged"
  mode.c_cc[VTIME] = 0;
  cfsetispeed(&mode, speed);
  cfsetospeed(&mode, speed);
  return tcsetattr(fd, TCSANOW, &mode) == 0 ? 0 : errno;
}

/// Asks a USB adapter to hand bytes on at once instead of every 16 ms. Other ports and pseudo terminals do not know this.
void ask_for_low_latency(int fd) {
  serial_struct settings{};
  if (ioctl(fd, TIOCGSERIAL, &settings) == 0) {
    settings.flags |= ASYNC_LOW_LATENCY;
    ioctl(fd, TIOCSSERIAL, &settings);
  }
}

}  // namespace

bool SerialPort::is_standard_rate(int baud) { return speed_of(baud) != B0; }

SerialPort::SerialPort(const SerialPortConfig& config)
    : device_(config.device), baud_(config.baud), buffer_(config.buffer_bytes) {
  if (!is_standard_rate(baud_)) {
    throw TransportError("serial port " + device_ + ": " + std::to_string(baud_) + " baud is no standard rate");
  }
}

SerialPort::~SerialPort() { close(); }

int SerialPort::open() {
  close();
  fd_ = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) {
    return errno;
  }
  if (const int error = make_raw(fd_, speed_of(baud_)); error != 0) {
    close();
    return error;
  }
  ask_for_low_latency(fd_);
  return 0;
}

void SerialPort::close() {
  if (fd_ >= 0) {
    ::close(fd_);
    fd_ = -1;
  }
  gone_ = false;
}

int SerialPort::set_baud(int baud) {
  SLAMD_ASSERT(is_standard_rate(baud));
  baud_ = baud;
  if (!is_open()) {
    return 0;
  }
  const int error = make_raw(fd_, speed_of(baud_));
  tcflush(fd_, TCIFLUSH);
  return error;
}

std::span<const std::byte> SerialPort::read() {
  if (!is_open() || gone_) {
    return {};
  }
  const ssize_t bytes = ::read(fd_, buffer_.data(), buffer_.size());
  if (bytes > 0) {
    return std::span(buffer_).first(static_cast<std::size_t>(bytes));
  }
  if (bytes == 0 || (errno != EAGAIN && errno != EINTR)) {
    gone_ = true;  // end of file, EIO, ENXIO
  }
  return {};
}

std::size_t SerialPort::write(std::span<const std::byte> bytes) {
  if (!is_open() || gone_ || bytes.empty()) {
    return 0;
  }
  const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
  return written > 0 ? static_cast<std::size_t>(written) : 0;
}

std::string SerialPort::explain(int error) const {
  const std::string words = std::generic_category().message(error);
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO: return "serial port " + device_ + ": not there (" + words + ")";
    case EACCES: return "serial port " + device_ + ": no permission (is the user in group dialout?)";
    case EBUSY: return "serial port " + device_ + ": taken by another process";
    case ENOTTY: return "serial port " + device_ + ": is no serial port";
    default: return "serial port " + device_ + ": " + words;
  }
}

}  // namespace slamd::transport
