#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "daemon/bus/publisher.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/pipeline/gnss_loop.hpp"
#include "daemon/pipeline/mapping_loop.hpp"
#include "daemon/pipeline/occupancy_loop.hpp"
#include "daemon/pipeline/odometry_loop.hpp"
#include "daemon/pipeline/preprocess_loop.hpp"
#include "daemon/pipeline/publish_loop.hpp"
#include "daemon/pipeline/receive_loop.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/pipeline/serial_loop.hpp"
#include "daemon/threads/heartbeat.hpp"
#include "daemon/threads/real_time_thread.hpp"

namespace slamd::pipeline {

/// The daemon's real-time threads and all that passes between them, on one page.
///
///   sockets, ─▶ receive ──blocks────────────▶ preprocess ──jobs──▶ odometry ──jobs──▶ publish ─▶ LCM
///   tty, CAN        │  └──inertial, wheels──────▲   ▲───feedback───┘                   ▲
///                   └──inertial─────────────────────────────────────────────────────────┘  ├─scans─▶ mapping ─▶ LCM
///                                                                                          └─scans─▶ occupancy ─▶ LCM
///
/// Mapping is no real-time thread: it gets copies of scans as far as there is room, and publish sends what it finds.
/// Nor is occupancy, which sends for itself; it gets clients' requests from housekeeping.
/// A serial port is opened, set and given up by a thread of its own, which may block; receive reads from it meanwhile. A
/// satellite receiver's port has one to itself; its fixes go to housekeeping alone, by Latest.
/// Rings and pools: rings.hpp says how long each is and what happens when it is full. A late odometry takes the newest
/// scan; nothing waits for anything that comes after it.
/// Housekeeping (the caller's thread) reads counts and events, and sets the map's placement.
/// Errors: the constructor throws transport::TransportError, bus::BusError, configuration::ConfigurationError.
/// Real-time: everything is allocated in the constructor.
class Pipeline {
 public:
  Pipeline(const configuration::Configuration& configuration, const transport::HostClock& clock);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  void start();

  /// Ends the threads; what is under way is given up.
  void stop();

  /// Whether every thread runs under SCHED_FIFO, as configured.
  bool is_fifo() const;

  /// Runs the threads so from now on. Housekeeping only.  Errors: false, and all run as before, where one may not.
  bool schedule(const configuration::RealtimeConfiguration& realtime);

  /// The threads' signs of life, from start() on.
  const std::vector<std::unique_ptr<threads::Heartbeat>>& heartbeats() const { return heartbeats_; }

  const ReceiveLoop& receive() const { return receive_; }
  const PreprocessLoop& preprocess() const { return preprocess_; }
  const OdometryLoop& odometry() const { return odometry_; }
  const PublishLoop& publish() const { return publish_; }

  /// nullptr where it is off.
  const MappingLoop* mapping() const { return mapping_.get(); }

  /// Asks for the corrected map, written to a file; take_corrected_map() gives it. Where mapping is on. Housekeeping only.
  void want_corrected_map(const CorrectedMapRequest::Wanted& wanted) { mapping_->corrected_map().want(wanted); }
  std::optional<CorrectedMap> take_corrected_map() { return mapping_->corrected_map().take(); }

  /// What the satellite receiver has said, at its serial port or in position packets.
  stages::GnssState gnss() const { return gnss_ ? gnss_->state() : receive_.counts().gnss; }

  /// Likewise, for after the threads have ended: by what became of it; empty without a receiver.
  stages::NamedCounts gnss_counts() const { return gnss_ ? gnss_->counts() : receive_.gnss(); }

  /// nullptr where it is off.
  const OccupancyLoop* occupancy() const { return occupancy_.get(); }

  /// Hands on what a client lacks of the map. Housekeeping only.
  void request_map(const occupancy::MapRequest& request) {
    if (occupancy_) {
      rings_.map_requests.try_push(request);
    }
  }

  const Rings& rings() const { return rings_; }

  /// Where the ordinary threads, the caller's among them, send.
  bus::Publisher& publisher() { return ordinary_publisher_; }

  /// Tells whose data are taken; see ReceiveLoop. Housekeeping only.
  void set_device(std::uint32_t address) { receive_.set_device(address); }

  /// Looks after the CAN interfaces: calls say(interface, what it is found to be, in words) where that is news.
  /// Housekeeping only, ten times a second or so.
  template <typename Say>
  void attend_can(Say&& say) {
    if (CanInput* can = receive_.can(); can != nullptr) {
      can->attend(say);
    }
  }

  /// For after the end: what has come of the wheels, by what became of it; empty without them.
  stages::NamedCounts wheels() const;

  /// Sets where the map as mapping corrects it lies in map. Housekeeping only.
  void place(const MapPlacement& placement) { rings_.placement.store(placement); }

  /// Where mapping has odom in the map that it corrects; identity as long as there is nothing to correct.
  MapCorrection correction() const { return rings_.correction.load().value_or(MapCorrection{}); }

  /// Lets odom and the map begin anew; returns the number of the epoch, which poses and counts will have. Housekeeping only.
  std::uint32_t begin_epoch() { return rings_.epoch_wanted.fetch_add(1, std::memory_order_relaxed) + 1; }

  /// The epoch that was begun last; counts of an older one belong to what was forgotten.
  std::uint32_t epoch() const { return rings_.epoch_wanted.load(std::memory_order_relaxed); }

  /// Asks for a copy of the map, which take_map() gives. Not while one is under way. Housekeeping only.
  void want_map() { rings_.map_wanted.fetch_add(1, std::memory_order_release); }

  /// Calls visit(p_odom) for each point that has come since the last call; returns whether the copy is whole.
  /// Housekeeping only.
  template <typename Visit>
  bool take_map(Visit&& visit) {
    const bool whole =
        rings_.map_copied.load(std::memory_order_acquire) == rings_.map_wanted.load(std::memory_order_relaxed);
    while (const auto cell = rings_.map_cells.try_pop()) {
      for (std::uint32_t i = 0; i < cell->count; ++i) {
        visit(cell->point(i));
      }
    }
    return whole;
  }

  /// Calls visit(ScanPose) for each scan since the last call. Housekeeping only.
  template <typename Visit>
  void take_scan_poses(Visit&& visit) {
    while (const auto pose = rings_.scan_poses.try_pop()) {
      visit(*pose);
    }
  }

  /// Calls visit(thread's name, EventRecord) for each event since the last call. Housekeeping only.
  template <typename Visit>
  void read_events(Visit&& visit) {
    const auto drain = [&](const char* thread, threads::EventRing& ring) {
      while (const auto record = ring.try_read()) {
        visit(thread, *record);
      }
    };
    drain("receive", receive_.events());
    drain("preprocess", preprocess_.events());
    drain("odometry", odometry_.events());
    drain("publish", publish_.events());
    if (mapping_) {
      drain("mapping", mapping_->events());
    }
    if (serial_) {
      drain("serial", serial_->events());
    }
    if (gnss_) {
      drain("gnss", gnss_->events());
    }
  }

 private:
  template <typename Loop>
  std::unique_ptr<threads::RealTimeThread> thread(const char* name, threads::Scheduling scheduling, bool may_block, Loop& loop);
  template <typename Loop>
  void run(const char* name, int priority, Loop& loop);

  configuration::Configuration configuration_;
  odometry::OdometryConfig odometry_config_;
  Rings rings_;
  bus::Publisher publisher_;             // the publish thread's alone: LCM has a lock, and no ordinary thread is to hold that one
  bus::Publisher ordinary_publisher_;    // of the ordinary threads
  ReceiveLoop receive_;
  PreprocessLoop preprocess_;
  OdometryLoop odometry_;
  PublishLoop publish_;
  std::unique_ptr<MappingLoop> mapping_;  // where it is on
  std::unique_ptr<OccupancyLoop> occupancy_;  // where it is on
  std::unique_ptr<SerialLoop> serial_;  // where the inertial sensor has a serial port
  std::unique_ptr<GnssLoop> gnss_;      // where the receiver has one
  std::atomic<bool> stopping_{false};  // written by stop(), read by all threads
  std::vector<std::unique_ptr<threads::Heartbeat>> heartbeats_;  // one a thread
  // Last: they end before what they work on.
  std::vector<std::unique_ptr<threads::RealTimeThread>> threads_;
  std::unique_ptr<threads::RealTimeThread> mapping_thread_;
  std::unique_ptr<threads::RealTimeThread> occupancy_thread_;
  std::unique_ptr<threads::RealTimeThread> serial_thread_;
  std::unique_ptr<threads::RealTimeThread> gnss_thread_;
};

/// A pool, ring or table and what it takes.
struct MemoryItem {
  std::string name;
  std::size_t count = 0;
  std::size_t item_bytes = 0;
};

/// Returns what a pipeline of this configuration reserves, for --memory-plan.
std::vector<MemoryItem> memory_plan(const configuration::Configuration& configuration);

}  // namespace slamd::pipeline
