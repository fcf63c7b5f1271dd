#pragma once

#include <filesystem>
#include <map>

#include "core/mapping/mapper.hpp"
#include "drivers/storage/session_writer.hpp"

namespace slamd::storage {

/// Keeps the session of a mapper: after each scan, whatever is new of the map. Poses are written again once a correction has
/// moved them by more than a millimetre or a tenth of a milliradian since they were written last.
/// Threads: the mapper's; may block on the disk.  Errors of the constructor: see SessionWriter.
class SessionRecorder {
 public:
  SessionRecorder(const std::filesystem::path& folder, const SessionBegin& begin, const SessionLimits& limits)
      : writer_(folder, begin, limits) {}

  /// Writes what an update of the mapper has brought.
  void note(const mapping::Mapper& mapper, const mapping::MapperUpdate& update);

  /// Writes what the session still lacks of the map: after a fault, or begun late. What is still refused is lacking then, too.
  void catch_up(const mapping::Mapper& mapper);

  /// Says that the session is over.
  void close() { writer_.close(); }

  SessionWriter& writer() { return writer_; }
  const SessionWriter& writer() const { return writer_; }

 private:
  struct KnownLoop {
    SessionLoop loop;
    bool is_written = false;  // as it is
  };

  void note_keyframe(const mapping::Mapper& mapper, std::size_t i);
  void note_retired(graph::KeyframeId id);
  void note_loops(const mapping::MapperUpdate& update);
  void note_poses(const mapping::Mapper& mapper, std::size_t from);

  SessionWriter writer_;
  std::map<graph::KeyframeId, geometry::Se3> written_;  // T_map_base, as a reader knows it
  std::vector<graph::KeyframeId> retired_;              // of which a reader does not know it yet
  std::map<graph::LoopId, KnownLoop> loops_;
  std::vector<SessionPose> moved_;  // scratch
};

}  // namespace slamd::storage
