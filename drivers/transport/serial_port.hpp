#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace slamd::transport {

struct SerialPortConfig {
  static constexpr std::size_t kBufferBytes = 4096;  // all that a terminal keeps

  std::string device;  // "/dev/ttyUSB0"
  int baud = 921'600;  // one of the standard rates
  std::size_t buffer_bytes = kBufferBytes;
};

/// Reads and writes the bytes of a serial port (or a pseudo terminal), raw and without blocking. A port that is unplugged
/// says so by is_gone(); open() may be called again until the device is back.
/// Threads: one at a time.  Real-time: allocates in the constructor only; read() never blocks, but open(), close() and
/// set_baud() may take milliseconds, and more, in the driver.
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

  /// Tells whether the device has gone since it was opened: close() is all that is left to do.
  bool is_gone() const { return gone_; }

  /// Sets the rate, now or with the next open(), and forgets what came at another one. Returns 0, or an errno.
  /// Errors: programmer error unless is_standard_rate().
  int set_baud(int baud);
  int baud() const { return baud_; }

  /// For epoll, level-triggered; -1 while closed.
  int fd() const { return fd_; }

  /// Returns what has come in; nothing when nothing waits, or when the device has gone. Valid until the next call.
  std::span<const std::byte> read();

  /// Writes what the driver has room for, and returns how many bytes that were.
  std::size_t write(std::span<const std::byte> bytes);

  /// Says in words why open() failed: "serial port /dev/ttyUSB0: not there (No such file or directory)".
  std::string explain(int error) const;

  static bool is_standard_rate(int baud);

 private:
  std::string device_;
  int baud_;
  int fd_ = -1;
  bool gone_ = false;
  std::vector<std::byte> buffer_;
};

}  // namespace slamd::transport
