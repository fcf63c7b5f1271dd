#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace slamd::transport {

struct SerialPortConfig {
  std::string device;  // "/dev/ttyUSB0"
  int baud = 921'600;  // one of the standard rates
  std::size_t buffer_bytes = 4096;
};

/// Reads bytes from a serial port (or a pseudo terminal), raw and without blocking. A port that is unplugged closes
/// itself; open() may be called again until the device is back.
/// Threads: one.  Real-time: allocates in the constructor only; open() and close() may take milliseconds in the driver.
class SerialPort {
 public:
  /// Opens nothing yet. Errors: TransportError when the rate is no standard one.
  explicit SerialPort(const SerialPortConfig& config);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// Opens the device and sets it raw. Returns 0, or the errno of what failed.
  [[nodiscard]] int open();

  void close();
  bool is_open() const { return fd_ >= 0; }

  /// For epoll, level-triggered; -1 while closed.
  int fd() const { return fd_; }

  /// Returns what has come in; nothing when nothing waits, or when the device has gone, after which is_open() is false.
  /// Valid until the next call.
  std::span<const std::byte> read();

  /// Says in words why open() failed: "serial port /dev/ttyUSB0: not there (No such file or directory)".
  std::string explain(int error) const;

  static bool is_standard_rate(int baud);

 private:
  std::string device_;
  unsigned speed_;
  int fd_ = -1;
  std::vector<std::byte> buffer_;
};

}  // namespace slamd::transport
