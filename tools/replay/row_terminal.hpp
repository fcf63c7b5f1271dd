#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace slamd::replay {

/// A pseudo terminal that looks like a sensor's serial port: a link leads to it, and rows come out of it.
class RowTerminal {
 public:
  /// Makes the terminal and the link, taking the place of an older link. Errors: std::runtime_error.
  explicit RowTerminal(const std::filesystem::path& link);
  ~RowTerminal();  // takes the link away
  RowTerminal(const RowTerminal&) = delete;
  RowTerminal& operator=(const RowTerminal&) = delete;

  /// Tells whether somebody has opened the terminal.
  bool has_reader() const;

  /// Sends a row, which ends in '\n'; returns false, and sends nothing, when nobody listens or the reader has fallen
  /// kMaxBacklogBytes behind.
  bool write(std::string_view row);

  /// Tells whether the reader has taken all there is; pushes what did not fit yet. Who goes away before loses it.
  bool is_drained();

  /// Rows that write() took, but that have not gone out.
  std::size_t rows_left() const;

 private:
  static constexpr std::size_t kMaxBacklogBytes = 65'536;

  /// Sets the reader's side raw, in case that it has not got to it yet: an echo would come back as rows.
  void make_raw();

  void push();

  std::filesystem::path link_;
  std::string name_;
  int fd_ = -1;          // the sensor's side
  bool heard_ = false;   // the last row was read
  std::string backlog_;  // what did not fit into the terminal
};

}  // namespace slamd::replay
