#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/odometry/odometry.hpp"
#include "daemon/stages/front_end.hpp"
#include "daemon/stages/packet_stage.hpp"
#include "drivers/recording/csv_reader.hpp"
#include "tools/replay/gnss_log.hpp"
#include "tools/replay/recording.hpp"

namespace slamd::replay {

/// One scan of a run.
struct ScanRecord {
  odometry::OdometryResult odometry;
  stages::StageTimes times;
  double decode_ms = 0.0;  // CPU time of this scan's packets
};

/// A step of a run where no scan had come for a while.
struct SilentRecord {
  Stamp stamp{};
  odometry::State state = odometry::State::kDegraded;
  odometry::Cause cause = odometry::Cause::kNoLidar;
};

/// What a run has seen and made.
struct Run {
  std::vector<ScanRecord> scans;
  std::vector<SilentRecord> silent;
  std::uint64_t scans_seen = 0;
  std::uint64_t scans_before_start = 0;  // while the inertial sensor was being levelled
  stages::NamedCounts packets;           // received and refused, by reason; the sum is what the capture holds
  stages::NamedCounts blocks;
  stages::NamedCounts imu;
  stages::NamedCounts wheel;
  std::optional<GnssSummary> gnss;
  std::vector<std::string> remarks;
  sensor::ClockHealth clock;
  std::optional<inertial::Alignment> alignment;
  calibration::SensorAgreement agreement;  // what the drive has shown of the sensors' places and clocks
  double wall_s = 0.0;
  double recording_s = 0.0;
};

/// Where a run's products go while it goes on.
struct Sinks {
  std::function<void(const ScanRecord&, const scan::DeskewedScan&, const odometry::MotionStep&)> scan;
  std::function<void(double share)> progress;  // of the recording, 0..1
  std::function<void(const odometry::OdometryResult&)> silence{};  // a step where no scan had come for a while
};

/// Packets and inertial samples that do not come from files.
class PacketSource {
 public:
  virtual ~PacketSource() = default;

  /// Gives the next datagram, in the order of their arrival; false at the end.
  virtual bool next(recording::Packet& packet) = 0;

  /// Gives the next sample of the external inertial sensor; false at the end, or when there is none.
  virtual bool next_imu(sensor::ImuSample& sample) = 0;

  /// Gives the next sample of the wheels; false at the end, or when there are none.
  virtual bool next_wheel(sensor::WheelSample& /*sample*/) { return false; }

  /// The share that was given out, 0..1.
  virtual double progress() const = 0;
};

/// Runs a recording through the stages of the daemon on a virtual clock, in one thread: the same recording gives the
/// same bytes, whatever the load. Events come in the order of their arrival: packets by capture stamp, inertial
/// samples by their own.
/// Errors: RecordingError.
Run replay(const Recording& recording, const Sinks& sinks);

/// The same for a source.
Run replay(const configuration::Configuration& configuration, PacketSource& source, const Sinks& sinks);

}  // namespace slamd::replay
