#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "daemon/configuration/configuration.hpp"
#include "drivers/imu/protocol.hpp"
#include "drivers/imu/unit_watch.hpp"
#include "drivers/livox/status_code.hpp"
#include "drivers/transport/interfaces.hpp"
#include "drivers/velodyne/position.hpp"
#include "tools/sensors/second_count.hpp"

namespace slamd::sensors {

// What is seen of the sensors of this computer, at one moment. Texts that come from devices hold printable ASCII only.

/// An inertial sensor's samples.
/// Frames: means are of specific force and turn rate in imu, over the last whole second.
struct InertialSeen {
  Count samples;
  std::uint64_t refused = 0;  // came, but are no sample
  std::uint64_t missing = 0;  // by the device's own count
  std::uint64_t clipped = 0;
  imu::Units units = imu::Units::kUnknown;
  Eigen::Vector3d mean_force_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_rate_radps = Eigen::Vector3d::Zero();
  double force_spread_mps2 = 0.0;  // rms about the mean

  /// Tells whether the last second is fit to judge gravity by: enough samples, at rest, about 9.8 m/s² long.
  bool shows_gravity() const;
};

enum class LidarProtocol : std::uint8_t { kVelodyne, kSdk1, kSdk2 };

/// Whose time a device's stamps tell, as its packets say.
enum class TimeSource : std::uint8_t { kUnknown, kFreeRunning, kPtp, kGps, kPps };

/// A LiDAR on the network.
struct LidarSeen {
  LidarProtocol protocol = LidarProtocol::kVelodyne;
  std::uint32_t address = 0;  // host order
  std::string code;           // a Livox's broadcast code or serial number
  std::string type;           // in words: "Livox Avia"
  std::optional<configuration::LidarModel> model;  // that slamd reads; none: it does not, or it is not known
  Count broadcasts;           // of SDK1: it looks for a host; of SDK2: it answers who looks for it
  double silent_s = 0.0;      // since the last of these
  Count packets;              // of points
  Count points;
  Count positions;            // position packets of a Velodyne
  std::uint64_t refused = 0;  // packets that came after good ones, and are none
  std::uint16_t port = 0;     // of this host, at which points come
  TimeSource time = TimeSource::kUnknown;
  std::optional<livox::StatusCode> status;         // SDK1, of its data
  std::optional<velodyne::PpsState> pps;           // of position packets
  std::string sentence;                            // of the receiver behind a Velodyne
  std::optional<std::uint32_t> sends_to;           // SDK2, asked: where its points go, host order; 0: nowhere
  std::optional<std::uint8_t> work_state;          // SDK2, asked: as the protocol counts
  std::optional<std::uint32_t> health_code;        // SDK2, asked: the first that is not 0
  std::optional<InertialSeen> imu;                 // its own
};

/// What speaks on a serial line.
enum class Tongue : std::uint8_t { kNone, kXsens, kMip, kCsv, kGnss };

/// A satellite receiver's fixes.
struct GnssSeen {
  Count sentences;  // of NMEA
  Count ubx;
  Count fixes;      // one for each moment, good or not
  Count good;
  std::string lacks;  // why the last one was not good
  unsigned satellites = 0;
  unsigned quality = 0;  // as GGA counts
};

/// A serial line.
struct LineSeen {
  std::string device;
  std::string trouble;  // why it cannot be listened to; empty: it is
  int baud = 0;         // at which it is listened to
  bool found = false;   // that is its rate
  Tongue tongue = Tongue::kNone;
  bool answers = false;  // asked; but it sends no samples
  int rounds = 0;        // through all rates, without anything that is known
  Count bytes;
  InertialSeen imu;
  GnssSeen gnss;
};

/// The frames of one id on a CAN bus.
struct CanIdSeen {
  std::uint32_t id = 0;
  bool is_extended = false;
  std::uint8_t size = 0;  // of the last one's data, bytes
  Count frames;
};

/// A CAN bus.
struct BusSeen {
  std::string interface;
  std::string trouble;  // why nothing can be heard; empty: all is well
  Count frames;
  std::uint64_t lost = 0;  // in the kernel, or by the controller
  std::uint64_t bus_off = 0;
  std::uint64_t ids_left_out = 0;  // frames of more ids than are kept
  std::vector<CanIdSeen> ids;
  InertialSeen xsens;    // an MTi-600
  InertialSeen aceinna;  // by the axis map "y,x,z"
};

/// An inertial sensor that sends rows of CSV in datagrams.
struct RowsSeen {
  std::uint32_t address = 0;  // host order
  std::uint16_t port = 0;     // of this host
  InertialSeen imu;
};

/// What an Avia says to whoever would be its host.
enum class AviaAnswer : std::uint8_t {
  kNotAsked,
  kNone,     // not yet, or no more
  kRefusal,  // it has a host
  kConsent,  // it had none, and was let go again
};

/// An Avia that was asked.
struct AviaSeen {
  std::uint32_t address = 0;  // host order
  AviaAnswer answer = AviaAnswer::kNotAsked;
  std::string hindrance;  // why it is not asked
};

/// A UDP port at which sensors are listened for.
struct PortSeen {
  std::uint16_t port = 0;
  std::string purpose;
  std::string owner;    // who has it, so that nothing is heard here; empty: it is listened to
  std::string beside;   // who listens to it, too
  std::string buffer;   // what is wrong with its receive buffer
  Count datagrams;
  Count strange;        // that are no sensor's
  std::uint32_t stranger = 0;  // who sent the last of them, host order
  std::uint64_t lost = 0;      // in the kernel, for the buffer was full
};

/// All of it.
struct Seen {
  double listened_s = 0.0;
  bool hears_wire = true;  // also what the kernel drops
  bool asked = false;
  std::vector<transport::Interface> interfaces;  // of this host
  std::vector<PortSeen> ports;
  std::vector<LidarSeen> lidars;
  std::vector<AviaSeen> avias;
  std::vector<RowsSeen> rows;
  std::vector<std::uint32_t> searchers;  // other hosts that look for SDK2 devices
  std::vector<LineSeen> lines;
  std::vector<BusSeen> buses;
  std::uint64_t left_out = 0;  // datagrams of more devices than are kept

  /// Tells whether anything at all was found that slamd reads, or that speaks for itself.
  bool anything() const;
};

/// Replaces whatever is no printable ASCII: it would move a terminal's cursor, or end a line of TOML.
std::string printable(std::string text);

}  // namespace slamd::sensors
