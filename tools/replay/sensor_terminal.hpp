#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace slamd::replay {

/// A pseudo terminal that looks like a sensor's serial port: a link leads to it, and a device's bytes come out of it.
class SensorTerminal {
 public:
  /// Makes the terminal and the link, taking the place of an older link; `greeting` is what each new reader hears first.
  /// Errors: std::runtime_error.
  explicit SensorTerminal(const std::filesystem::path& link, std::string greeting = {});
  ~SensorTerminal();  // takes the link away
  SensorTerminal(const SensorTerminal&) = delete;
  SensorTerminal& operator=(const SensorTerminal&) = delete;

  /// Tells whether somebody has opened the terminal.
  bool has_reader() const;

  /// Sends a sample or an answer; returns false, and sends nothing, when nobody listens or the reader has fallen
  /// kMaxBacklogBytes behind.
  bool write(std::string_view bytes);

  /// What the reader has sent to the device; valid until the next call.
  std::span<const std::byte> read();

  /// Tells whether the reader has taken all there is; pushes what did not fit yet. Who goes away before loses it.
  bool is_drained();

  /// Samples and answers that write() took, but that have not gone out.
  std::size_t writes_left() const { return ends_.size(); }

 private:
  static constexpr std::size_t kMaxBacklogBytes = 65'536;

  /// Sets the reader's side raw, in case that it has not got to it yet: an echo would come back as bytes.
  void make_raw();

  void push();

  std::filesystem::path link_;
  std::string greeting_;
  std::string name_;
  int fd_ = -1;          // the sensor's side
  bool heard_ = false;   // somebody has read the last bytes
  std::string backlog_;  // what did not fit into the terminal
  std::uint64_t taken_bytes_ = 0;
  std::uint64_t pushed_bytes_ = 0;
  std::deque<std::uint64_t> ends_;  // in taken_bytes_, of each write that has not gone out
  std::array<std::byte, 1024> heard_bytes_{};
};

}  // namespace slamd::replay
