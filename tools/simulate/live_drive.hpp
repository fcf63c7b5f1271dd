#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/replay/network_player.hpp"
#include "tools/simulate/driven_vehicle.hpp"
#include "tools/simulate/packet_stream.hpp"

namespace slamd::simulate {

/// What happens in a moment of a drive, each list by time.
struct Moment {
  struct Row {
    double t_s = 0.0;
    InertialReading reading;
  };
  struct Fix {
    double t_s = 0.0;
    GnssReading reading;
  };
  struct Wheels {
    double t_s = 0.0;
    WheelReading reading;
  };
  struct Truth {
    double t_s = 0.0;
    MotionState motion;
  };

  double end_s = 0.0;
  Velocity command;
  std::uint32_t collisions = 0;  // since the start of the drive
  std::vector<SentPacket> packets;
  std::vector<Row> rows;         // of the external inertial sensor
  std::vector<Fix> fixes;        // of the satellite receiver
  std::vector<Wheels> wheels;    // kWheel_hz a second
  std::vector<Truth> truths;     // 100 a second
};

/// A drive that grows by one knot of its motion at a time, as it is told. A command moves the vehicle kDelay_s
/// after the beginning of its moment: a motion is known only so far behind its control points.
class LiveDrive {
 public:
  /// `drive.driven` must be set.
  explicit LiveDrive(const Drive& drive);

  static constexpr double kDelay_s = 4.0 * Motion::kKnot_s;

  /// Drives and senses for another Motion::kKnot_s.
  Moment next(const Velocity& command);

  const Scene& scene() const { return scene_; }
  const DrivenVehicle& vehicle() const { return vehicle_; }

 private:
  Scene scene_;
  DrivenVehicle vehicle_;
  PacketStream packets_;
  InertialSensor imu_;
  GnssSensor gnss_;
  WheelSensor wheels_;
  std::uint64_t knots_ = 0;
  std::uint64_t wheel_readings_ = 0;
  std::uint64_t truths_ = 0;
};

/// A LiDAR that knows by itself where its packets go.
class PacketOutlet {
 public:
  virtual ~PacketOutlet() = default;

  /// Sends a packet whose time has come, or keeps it. Wall clock minus stamps of the drive: when it was taken.
  virtual void send(std::span<const std::byte> payload, Duration wall_minus_recorded) = 0;
};

/// Where a live drive goes, and who commands it.
struct LiveOptions {
  replay::ToNetworkOptions target;
  std::string lcm_url;
  std::string lcm_prefix;
  std::filesystem::path directory;  // of a recording; empty: none
};

/// What became of an emulated device.
struct DeviceReport {
  std::uint64_t sent = 0;        // packets
  std::uint64_t unwanted = 0;    // by any host, or by the network
  std::uint64_t utc_told = 0;    // an Avia: how often
  std::uint64_t utc_unused = 0;  // of those: without PPS, or not in time after an edge
};

/// What became of a live drive.
struct LiveReport {
  replay::ToNetworkReport sent;
  double driven_s = 0.0;
  double path_m = 0.0;
  std::uint64_t commands = 0;
  std::uint64_t commands_malformed = 0;
  std::uint32_t collisions = 0;
  std::optional<DeviceReport> device;
};

/// Drives a vehicle by velocity commands from LCM in real time: its sensors' packets and rows go to the network as they
/// would from a vehicle, the truth to LCM, and all of it into a recording if one is asked for. It ends after the
/// drive's duration, or when the user has enough. `say` hears of collisions. With an outlet the LiDAR's packets go there,
/// each at its time, in place of the target.
/// Errors: BusError; RecordingError; std::runtime_error for what the network refuses.
LiveReport drive_live(const Drive& drive, const LiveOptions& options, replay::SendClock& clock,
                      const std::function<bool()>& stopped, const std::function<void(double share)>& progress,
                      const std::function<void(const std::string&)>& say, PacketOutlet* outlet = nullptr);

/// Writes a report as one JSON object, or as a few lines for a terminal.
std::string json_of(const LiveReport& report);
std::string summary_of(const LiveReport& report);

}  // namespace slamd::simulate
