#pragma once

#include "core/base/latest.hpp"
#include "daemon/bus/publisher.hpp"
#include "daemon/bus/text.hpp"
#include "daemon/pipeline/corrected_map.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/stages/mapping_stage.hpp"
#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/storage/session_keeper.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// What the mapping thread shows.
struct MappingCounts {
  std::uint64_t scans = 0;
  std::uint64_t keyframes = 0;  // that the map holds
  std::uint64_t retired = 0;    // for others, at the limit
  std::uint64_t candidates = 0;
  std::uint64_t verified = 0;
  std::uint64_t accepted = 0;
  std::uint64_t removed = 0;
  std::uint64_t session_bytes = 0;   // of the session that is written
  bus::Text<79> session_fault;       // why it cannot be; empty: it can
};

/// Returns where a configuration wants the map to be kept.
storage::SessionKeeping session_keeping(const configuration::Configuration& configuration);

/// The mapping thread: keyframes, loops, corrections. Not a real-time one: it takes time and memory as it needs them, at
/// ordinary priority, and no other thread ever waits for it. It copies what it keeps of a scan at once, so that the
/// scan's points are free again.
/// It keeps the map in a session, too, and may wait for the disk.
/// When late the ring of scans holds half a minute of them; points are for fewer scans than that, clouds then have less.
/// Threads: run_once() and finish() by one; counts() by any.
class MappingLoop {
 public:
  MappingLoop(const mapping::MapperConfig& config, const storage::SessionKeeping& keeping, const transport::HostClock& clock,
              Rings& rings, bus::Publisher& publisher);

  /// Sleeps until there is a scan, at most `longest`, and takes it in; it is not waited for where there are more.
  void run_once(Duration longest);

  /// Takes the last keyframe in and closes the session, after the thread has ended.
  void finish();

  CorrectedMapRequest& corrected_map() { return corrected_map_; }

  MappingCounts counts() const { return shown_.load().value_or(MappingCounts{}); }
  threads::EventRing& events() { return events_; }
  const threads::StageMonitor& monitor() const { return monitor_; }

 private:
  void take(MapScan& scan);
  void note(const mapping::MapperUpdate& update);
  void keep_session();
  void write_map(const CorrectedMapRequest::Wanted& wanted);
  void correct();
  void send_submaps(Stamp now);

  transport::HostClock clock_;
  Rings& rings_;
  bus::Publisher& publisher_;
  stages::MappingStage stage_;
  storage::SessionKeeper keeper_;
  std::filesystem::path told_session_;  // what was said of it last
  bool told_fault_ = false;
  CorrectedMapRequest corrected_map_;
  std::uint32_t shown_correction_ = 0;
  std::uint64_t placement_version_ = 0;
  bool submaps_changed_ = false;
  std::uint64_t scans_ = 0;
  Stamp last_submaps_sent_{};
  // Written by the mapping thread, read by health.
  Latest<MappingCounts> shown_;
  threads::EventRing events_;
  threads::StageMonitor monitor_;
};

}  // namespace slamd::pipeline
