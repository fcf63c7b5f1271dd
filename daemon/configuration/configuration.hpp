#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/geometry/se3.hpp"
#include "core/odometry/odometry_config.hpp"
#include "daemon/configuration/device.hpp"
#include "drivers/can/can_signal.hpp"
#include "drivers/can/wheel_signals.hpp"
#include "drivers/imu/protocol.hpp"

namespace slamd::configuration {

/// Bad configuration: one line with file, line, key, value and what is allowed. Programs print it and exit with 2.
/// A value or a key that holds a line break is shown with a space in its place.
class ConfigurationError : public std::runtime_error {
 public:
  explicit ConfigurationError(std::string message) : std::runtime_error(on_one_line(std::move(message))) {}

 private:
  static std::string on_one_line(std::string message) {
    for (char& c : message) {
      c = c == '\n' || c == '\r' ? ' ' : c;
    }
    return message;
  }
};

/// The LiDAR models of this release.
enum class LidarModel { kVlp16, kVlp16HiRes, kVlp32c, kHdl32e, kLivoxAvia, kLivoxMid360, kPoints };

/// Tells whether a model is a Livox: cut by time, with an inertial sensor of its own, sending wherever it is told to.
bool is_livox(LidarModel model);


/// Whose time a sensor's stamps tell.
enum class SensorClock { kEstimated, kShared };

/// Tells whether a recording's file is what candump -l writes.
inline bool is_can_log(const std::string& source) { return source.ends_with(".log"); }

struct LidarConfiguration {
  LidarModel model = LidarModel::kVlp16;
  std::string source;         // file or folder in the recording; empty: the recording's only pcap
  int port = 0;               // UDP destination port of the data; 0: the model's own
  int position_port = 8308;   // Velodyne position packets
  int imu_port = 56401;       // a Mid-360's own inertial samples
  std::string bind_address = "0.0.0.0";  // of this host; live
  std::string source_address;            // the sensor's; empty: the first that sends good packets; live
  geometry::Se3 T_base_lidar;
  double cut_azimuth_deg = 180.0;
  Duration scan_period = std::chrono::milliseconds(100);
  SensorClock clock = SensorClock::kEstimated;
  bool vertical_parallax = false;
  bool points_have_time = true;  // false: the clouds of a points folder are compensated already
  double scans_per_second = 10.0;  // of a points folder without stamps
  DeviceConfiguration device;

  /// Returns the UDP destination port of the data: the model's own where none is configured; 0 for a Livox, which
  /// sends to whatever port it is told.
  int data_port() const;

  /// Returns the port at which the daemon takes the data: for a Livox where none is configured, the SDK's.
  int listening_port() const;

  /// Returns the port from which the daemon talks to a Livox.
  int command_port() const;
};

struct ImuConfiguration {
  bool enabled = false;       // true as soon as the table is there
  std::string source;         // file in the recording, "livox", or live "udp", "serial" or "can"
  int port = 7501;            // UDP destination port of "udp"
  std::string device;         // terminal of "serial"
  int baud = 921'600;         // its rate; 0: is found by listening
  imu::Protocol protocol = imu::Protocol::kCsv;  // of "serial", "can" and logs
  int rate_hz = 0;            // samples that an Xsens or a MicroStrain is told to send; 0: it is left as it is
  std::string interface;           // of "can"; of a log: empty for all
  std::string axis_map = "y,x,z";  // of an Aceinna: see can::parse_axis_map
  int can_address = -1;            // of an Aceinna; -1: whichever speaks
  std::optional<geometry::Se3> T_base_imu;
  SensorClock clock = SensorClock::kEstimated;

  /// Tells whether the samples come from a port of this host rather than from a file or the LiDAR.
  bool is_live_port() const { return source == "udp" || source == "serial" || source == "can"; }

  /// Tells whether the samples come as CAN frames, live or from a candump log.
  bool is_on_can() const { return source == "can" || is_can_log(source); }
};

struct WheelConfiguration {
  bool use = true;
  std::string source;     // file in the recording, or live "can"; empty: none
  std::string interface;  // of "can"; of a log: empty for all
  can::WheelModel model = can::WheelModel::kDifferential;
  double track_m = 0.5;
  double wheelbase_m = 2.5;
  std::optional<can::CanSignal> left;  // m/s
  std::optional<can::CanSignal> right;
  std::optional<can::CanSignal> speed;     // m/s
  std::optional<can::CanSignal> steering;  // rad

  /// Tells whether the samples come as CAN frames, live or from a candump log.
  bool is_on_can() const { return source == "can" || is_can_log(source); }
};

struct GnssConfiguration {
  bool use = false;
  std::string source;  // file in the recording, "velodyne" (position packets), or live "serial"
  std::string device;  // terminal of "serial"
  int baud = 0;        // its rate; 0: is found by listening
  geometry::Se3 T_base_antenna;

  bool is_serial() const { return source == "serial"; }
  bool is_velodyne() const { return source == "velodyne"; }
};

/// The map that corrects itself: keyframes and loops. What is not here has no key: see mapping::MapperConfig.
struct MappingConfiguration {
  bool use = true;
  bool loop_net = true;
  int keyframes = 10'000;         // at most; then the most redundant one is given up for each new one
  int loops = 4'096;              // at most
  int cloud_points = 4'096;       // of a keyframe
  double spacing_indoor_m = 1.0;  // of keyframes
  double spacing_outdoor_m = 2.0;
  double view_deg = 180.0;        // between the headings of keyframes that are compared
  std::string session_directory;  // live: where the map is kept while it grows; empty: nowhere
  int session_quota_mb = 2'000;   // of all sessions there
  int sessions = 10;              // that are kept there at most
};

struct OutputConfiguration {
  double map_spacing_m = 0.10;
  std::string save_directory;  // live: where the command "save" writes; empty: nowhere
};

/// How the daemon's threads run; a replay has none.
struct RealtimeConfiguration {
  bool fifo = true;         // SCHED_FIFO where it is permitted
  int priority = 50;        // of the odometry; the threads before it lie up to three higher
  bool lock_memory = true;  // mlockall where it is permitted
};

/// Where the messages go.
struct LcmConfiguration {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string prefix = "SLAMD";  // of the channels: 1 to 40 letters, digits, '_' and '-'
  int scan_points = 2000;        // of a scan that are sent; 0: no scans
};

/// What the daemon writes of itself.
struct LogConfiguration {
  Duration repeat_period = std::chrono::seconds(5);
};

/// Everything that a run is made of. Extrinsics reach the odometry through `resolved_odometry`.
struct Configuration {
  LidarConfiguration lidar;
  ImuConfiguration imu;
  WheelConfiguration wheel;
  GnssConfiguration gnss;
  odometry::OdometryConfig odometry;
  MappingConfiguration mapping;
  OutputConfiguration output;
  RealtimeConfiguration realtime;
  LcmConfiguration lcm;
  LogConfiguration log;
};

/// The names of [[lidar]] model, as configured.
const char* name_of(LidarModel model);

/// Returns the odometry's configuration with the sensors' places filled in: T_base_imu follows from T_base_lidar for a
/// built-in sensor, and is identity without one.
odometry::OdometryConfig resolved_odometry(const Configuration& configuration);

}  // namespace slamd::configuration
