#pragma once

#include <cstdint>

#include "core/base/counter.hpp"
#include "core/base/spsc_queue.hpp"
#include "core/base/stamp.hpp"

namespace slamd::threads {

/// What a real-time thread has to say. It writes a record; housekeeping makes a sentence of it.
enum class Event : std::uint8_t {
  kLidarHeard,          // value: source address
  kLidarSilent,
  kImuHeard,
  kImuSilent,
  kWheelsHeard,
  kWheelsSilent,
  kCanBusOff,           // value: the kernel's number of the interface, as of all of CAN
  kCanRestarted,
  kCanWarning,
  kCanPassive,
  kCanControllerLost,
  kCanKernelLost,
  kSerialLost,
  kSerialOpen,
  kSerialRefused,       // value: errno of what failed
  kSerialSilent,        // opened anew, for nothing comes
  kSerialFound,         // value: rate in baud
  kImuConfigured,       // value: samples a second
  kImuRefused,          // value: the sensor's error code
  kImuTakenAsItIs,
  kImuMute,
  kGnssFound,           // value: rate in baud
  kGnssFix,
  kGnssNoFix,
  kBlockPoolEmpty,      // value: blocks dropped so far
  kScanDropped,         // value: scans dropped so far, no free job
  kScanSkipped,         // value: scans skipped so far, the odometry was late
  kImuLate,             // value: scans that went on without their samples so far
  kStarted,             // value: 1 at rest, 0 in motion, 2 without inertial sensor
  kNewMap,              // by command: odom begins anew
  kStateChanged,        // value: state * 256 + cause
  kPoseReset,           // value: reset counter
  kMapCorrected,        // value: corrections so far
  kLoopRemoved,         // value: the loop's number
  kSessionBegun,        // value: when, Unix seconds: its name
  kSessionFault,
  kSessionGoesOn,
};

struct EventRecord {
  Stamp stamp{};
  Event event = Event::kLidarHeard;
  std::uint64_t value = 0;
};

/// Carries records from one real-time thread to housekeeping. When full the newest is dropped, counted.
/// Threads: write() by the real-time thread, try_read() by housekeeping.  Real-time: wait-free.
class EventRing {
 public:
  explicit EventRing(std::size_t capacity = 256) : records_(capacity) {}

  void write(Stamp stamp, Event event, std::uint64_t value = 0) {
    if (!records_.try_push(EventRecord{stamp, event, value})) {
      dropped_.add();
    }
  }

  std::optional<EventRecord> try_read() { return records_.try_pop(); }
  std::uint64_t dropped() const { return dropped_.value(); }

 private:
  SpscQueue<EventRecord> records_;
  Counter dropped_;
};

}  // namespace slamd::threads
