#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <span>
#include <string>

#include "drivers/storage/session_records.hpp"

namespace slamd::storage {

struct SessionLimits {
  std::uint64_t segment_bytes = 64U << 20U;  // a new file is begun then; a record that is larger has one to itself
  std::uint64_t quota_bytes = 0;             // of the whole session; 0: none
};

/// Returns a segment's name: "000012.slamd".
std::string segment_name(std::uint32_t segment);

/// Tells whether a file is named as a segment.
bool is_segment_name(const std::filesystem::path& file);

/// Writes a session while the map grows: records are only ever appended, to one file after the other. Each is handed to the
/// kernel whole, so that a killed process loses none; sync() brings them to the disk.
/// At the quota the oldest file goes, with what it holds of the map: said by dropped_segments().
/// Once a write fails (disk full, gone), the file is cut back to its last whole record and fault() says why; what comes then is
/// dropped and counted, until retry() finds that it can be written again.
/// Threads: one, which may block.  Errors of the constructor: std::runtime_error with the folder and the cause.
class SessionWriter {
 public:
  /// Begins a session in a folder, which is made; earlier segments in it are taken away.
  SessionWriter(const std::filesystem::path& folder, const SessionBegin& begin, const SessionLimits& limits);
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  // Each returns whether it was written, and not dropped.
  bool write(const SessionKeyframe& keyframe) { return append(SessionRecord::kKeyframe, payload_of(keyframe)); }
  bool write(const SessionLoop& loop) { return append(SessionRecord::kLoop, payload_of(loop)); }
  bool write(std::span<const SessionPose> poses);
  bool retire(graph::KeyframeId id) { return append(SessionRecord::kRetired, payload_of_retired(id)); }

  /// Brings everything written to the disk: to be called once a second.
  void sync();

  /// Says that the session is over, and syncs.
  void close();

  /// Why nothing can be written; empty: it can.
  const std::string& fault() const { return fault_; }

  /// Tries to go on after a fault, in a new file. Returns whether it could. Where nothing was written since the last try, its file goes.
  bool retry();

  std::uint64_t dropped_records() const { return dropped_records_; }
  std::uint32_t dropped_segments() const { return dropped_segments_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Closed {
    std::filesystem::path file;
    std::uint64_t bytes = 0;
  };

  bool append(SessionRecord kind, const RecordBytes& payload);
  bool append_bytes(const RecordBytes& bytes);
  bool open_segment();
  void close_segment();
  void remove_empty_segment();
  void keep_quota();
  void fail(const std::string& what);

  std::filesystem::path folder_;
  SessionBegin begin_;
  SessionLimits limits_;
  int fd_ = -1;
  std::uint64_t segment_bytes_ = 0;  // of the open one
  std::uint32_t segment_records_ = 0;  // likewise, the begin among them
  std::uint64_t bytes_ = 0;          // of all that are there
  std::uint32_t next_number_ = 0;
  std::deque<Closed> closed_;
  std::string fault_;
  std::uint64_t dropped_records_ = 0;
  std::uint32_t dropped_segments_ = 0;
};

}  // namespace slamd::storage
