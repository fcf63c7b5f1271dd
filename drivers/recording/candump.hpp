#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "drivers/transport/can_frame.hpp"

namespace slamd::recording {

/// What a line of a candump log is found to be.
enum class CanLine : std::uint8_t {
  kFrame,
  kOther,      // a remote request, an error frame, a frame of CAN FD
  kMalformed,
};

/// Reads a line as candump -l writes it: "(1436509052.249713) can0 1F334455#1122334455667788"; a letter for the direction
/// may follow. Of a frame, `interface` is then its interface, and part of the line.
CanLine parse_candump(std::string_view line, transport::CanFrame& frame, std::string_view& interface);

/// Writes such a line, with its end; the stamp to the microsecond.
std::string candump_line(std::string_view interface, const transport::CanFrame& frame);

struct CandumpCounters {
  std::uint64_t frames = 0;   // of the interface that was asked for
  std::uint64_t foreign = 0;  // of others
  std::uint64_t other = 0;
  std::uint64_t malformed = 0;
};

/// Reads the frames of a candump log, in the order of the file.
/// Errors: RecordingError for a file that cannot be read; bad lines are counted and passed over.
class CandumpReader {
 public:
  /// interface: whose frames; empty: all.
  explicit CandumpReader(const std::filesystem::path& file, std::string interface = {});

  /// Reads the next frame; false at the end.
  bool next(transport::CanFrame& frame);

  const CandumpCounters& counters() const { return counters_; }

 private:
  std::ifstream stream_;
  std::string interface_;
  std::string line_;
  CandumpCounters counters_;
};

}  // namespace slamd::recording
