#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"
#include "core/mapping/mapper.hpp"
#include "drivers/storage/session_recorder.hpp"

namespace slamd::storage {

struct SessionKeeping {
  std::filesystem::path folder;       // of all sessions; empty: none is kept
  std::uint64_t quota_bytes = 0;      // of all sessions together; 0: none
  std::size_t sessions = 10;          // at most, the one that is written among them
  std::uint64_t least_segment_bytes = 1'000'000;  // a small quota does not make files smaller than that
  std::string sensor;
  std::string software;
};

/// Returns a session's folder by when it began, in UTC: "20260131T235959Z".
std::string session_name(Stamp begun);

/// Tells whether a folder is named as a session of a keeper: nothing else is ever taken away.
bool is_session_name(const std::filesystem::path& folder);

/// Returns what the session that is written is held to: its files are an eighth of the quota at most.
SessionLimits limits_of(const SessionKeeping& keeping);

/// Keeps the sessions of a mapper in a folder, one a map: begins one with the first keyframe, brings it to the disk once a
/// second, and makes room by taking others away: first those that hold next to nothing, as each start that soon ends leaves one, then
/// those whose last file was written longest ago.
/// At the quota the others go first, and where there is none the oldest file of its own. Where nothing can
/// be written, fault() says why; it is tried again every ten seconds, and what the session lacks then is written.
/// Threads: the mapper's; may block on the disk. Never throws.
class SessionKeeper {
 public:
  explicit SessionKeeper(SessionKeeping keeping);

  /// Writes what an update of the mapper has brought, and does what is due at `now`.
  void note(const mapping::Mapper& mapper, const mapping::MapperUpdate& update, Stamp now);

  /// Does what is due: to be called a few times a second.
  void attend(const mapping::Mapper& mapper, Stamp now);

  /// Ends the session: the map begins anew, or the program ends.
  void close();

  bool is_on() const { return !keeping_.folder.empty(); }

  /// Folder of the session that is written; empty: none.
  const std::filesystem::path& session() const { return session_; }
  /// When it was begun: what its name says.
  Stamp begun() const { return begun_; }
  /// Why nothing can be written; empty: it can.
  const std::string& fault() const { return fault_; }
  /// Of the session that is written.
  std::uint64_t bytes() const { return recorder_ ? recorder_->writer().bytes() : 0; }
  /// Sessions that were taken away since the begin.
  std::uint64_t removed() const { return removed_; }

 private:
  struct Other {
    std::filesystem::path folder;
    std::uint64_t bytes = 0;
    std::filesystem::file_time_type written;  // last
  };

  bool begin(Stamp now);
  void look_for_others();
  static Other look_at(const std::filesystem::path& folder);
  void make_room();
  void remove_first();

  SessionKeeping keeping_;
  std::optional<SessionRecorder> recorder_;
  std::filesystem::path session_;
  Stamp begun_{};
  std::vector<Other> others_;  // in the order in which they go
  std::uint64_t removed_ = 0;
  std::string fault_;
  bool lacks_ = false;  // the session does not hold all of the map
  Stamp last_sync_{};
  Stamp last_try_{};
};

}  // namespace slamd::storage
