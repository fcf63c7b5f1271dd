#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/base/stamp.hpp"
#include "core/sensor/gnss_fix.hpp"
#include "core/sensor/imu_sample.hpp"
#include "daemon/configuration/configuration.hpp"
#include "drivers/recording/packet.hpp"
#include "tools/replay/emulated_gnss.hpp"
#include "tools/replay/emulated_imu.hpp"
#include "tools/replay/sensor_terminal.hpp"

namespace slamd::replay {

/// Where packets and inertial rows are sent to, and how fast.
struct ToNetworkOptions {
  std::uint32_t address = 0;        // host order
  std::uint16_t data_port = 0;      // 0: the one that each packet was recorded with
  std::uint16_t position_port = 0;  // Velodyne position packets, a Mid-360's inertial ones; 0: as above
  double speed = 1.0;               // 0: as fast as kBurst packets and a pause go

  // Inertial samples: a row a datagram, or through a pseudo terminal as a sensor sends them. Neither: they are left out.
  std::uint32_t imu_address = 0;
  std::uint16_t imu_port = 0;
  std::filesystem::path imu_terminal;
  imu::Protocol imu_protocol = imu::Protocol::kCsv;  // of the terminal
  int imu_rate_hz = 200;                             // at which the emulated sensor measures

  // Fixes of a satellite receiver, through a pseudo terminal; empty: they are left out.
  std::filesystem::path gnss_terminal;
  GnssTalk gnss_talk = GnssTalk::kNmea;
  std::string can_interface;  // where the frames of the recording's candump logs go; empty: nowhere
};

/// Reads nmea:LINKPATH, ubx:LINKPATH or both:LINKPATH. Errors: cli::UsageError.
void parse_gnss_destination(const std::string& text, ToNetworkOptions& options);

/// Reads HOST[:DATA_PORT[:POSITION_PORT]]. Errors: cli::UsageError, which names the command line's option.
void parse_destination(const std::string& option, const std::string& text, ToNetworkOptions& options);

/// Reads udp:HOST:PORT, or pty:LINKPATH (rows), xsens:LINKPATH or mip:LINKPATH. Errors: cli::UsageError.
void parse_imu_destination(const std::string& text, ToNetworkOptions& options);

/// The clock by which packets are sent; tests have one of their own.
class SendClock {
 public:
  virtual ~SendClock() = default;
  virtual Duration now() = 0;
  virtual void sleep_until(Duration deadline) = 0;  // returns earlier on a signal
};

/// CLOCK_MONOTONIC.
class MonotonicSendClock : public SendClock {
 public:
  Duration now() override;
  void sleep_until(Duration deadline) override;
};

/// What was sent, to the last packet.
struct ToNetworkReport {
  std::uint64_t lidar = 0;
  std::uint64_t position = 0;
  std::uint64_t imu_packets = 0;  // of a Livox's built-in sensor
  std::uint64_t imu_rows = 0;
  std::uint64_t gnss_fixes = 0;
  std::uint64_t can_frames = 0;

  std::uint64_t foreign = 0;        // packets to other ports, and refused frames: not sent
  std::uint64_t imu_unheard = 0;    // rows that nobody read from the terminal
  std::uint64_t gnss_unheard = 0;   // fixes that nobody read from the terminal
  std::uint64_t imu_withheld = 0;   // rows that the emulated sensor did not send: was being configured, or to a lower rate
  std::uint64_t imu_outside = 0;    // rows more than kImuMargin before the first packet or after the last
  std::uint64_t imu_refused = 0;    // bad rows of the file
  std::uint64_t can_outside = 0;    // as imu_outside
  std::uint64_t can_refused = 0;    // lines of the logs that are no frames with data
  Duration worst_lateness{};        // of a packet or a row behind its deadline
  Duration mean_lateness{};
  Duration recording{};             // from the first event sent to the last
  Duration took{};
  Duration wall_minus_recorded{};   // wall clock at the first event's deadline, minus its stamp: what live stamps are later by
  bool interrupted = false;
};

/// At most this many packets go back to back.
inline constexpr int kBurst = 32;
inline constexpr Duration kBurstPause = std::chrono::milliseconds(2);

inline constexpr Duration kImuMargin = std::chrono::seconds(2);

/// How long the first packet waits for a reader of the pseudo terminal.
inline constexpr Duration kReaderPatience = std::chrono::seconds(10);

/// Asks the system to let this thread, and none that it starts, run ahead of ordinary ones: a sensor is not late because
/// this computer is busy.
void ask_for_punctuality();

/// Sends packets and inertial rows to the network, each at an absolute deadline by its stamp, and counts them.
/// Time does not run backwards: what is stamped earlier than what was sent before goes at once.
/// Errors: std::runtime_error for what the network refuses, or a terminal that cannot be made.
class NetworkPlayer {
 public:
  /// `lidar`, `options`, `clock` and `stopped` (whether the user wants no more; may be empty) must outlive the player.
  NetworkPlayer(const configuration::LidarConfiguration& lidar, const ToNetworkOptions& options, SendClock& clock,
                const std::function<bool()>& stopped);
  ~NetworkPlayer();

  /// Tells whether inertial rows go anywhere.
  bool takes_rows() const;

  /// Tells whether fixes go anywhere.
  bool takes_fixes() const { return gnss_terminal_ != nullptr; }

  /// Waits up to kReaderPatience until somebody reads each terminal, if there are any.
  void wait_for_reader();

  /// Lets what is stamped `first` be due now; where fixes go, up to a second later: whole seconds of stamps are then such of
  /// the wall clock.
  void begin(Stamp first);

  /// Waits for the packet's time and sends it; a packet that is none of the LiDAR's is only counted.
  void send(const recording::Packet& packet);

  /// Waits until a row is due, whatever its stamp, and sends it; false when the user does not want it any more.
  bool send(const sensor::ImuSample& row, Stamp due);

  /// Waits until a fix is due and sends it as a receiver does, with the wall clock's UTC; as above.
  bool send(const sensor::GnssFix& fix, Stamp due);

  /// Waits for the time of something else; false when the user does not want it any more.
  bool wait_until(Stamp due);

  /// Ends the sending, and returns the counts.
  ToNetworkReport finish();

  bool interrupted() const { return report_.interrupted; }

  /// The stamp of what was sent last.
  Stamp now() const { return now_; }

  /// Wall clock minus stamps.
  Duration wall_minus_recorded() const { return report_.wall_minus_recorded; }

 private:
  class Socket;
  enum class Kind { kData, kPosition, kImu, kForeign };

  Kind kind_of(const recording::Packet& packet) const;
  bool is_stopped();
  void serve_terminal();
  void drain_terminals();

  const configuration::LidarConfiguration& lidar_;
  const ToNetworkOptions& options_;
  SendClock& clock_;
  const std::function<bool()>& stopped_;
  std::unique_ptr<Socket> socket_;
  std::unique_ptr<SensorTerminal> terminal_;
  std::unique_ptr<SensorTerminal> gnss_terminal_;
  std::unique_ptr<EmulatedImu> device_;  // at the terminal
  std::string device_bytes_;             // scratch
  Stamp first_{};
  Stamp now_{};       // of the stamps
  Duration begin_{};  // on the clock, for first_
  int back_to_back_ = 0;
  Duration lateness_sum_{};
  std::int64_t events_ = 0;
  ToNetworkReport report_;
};

/// Writes a report as one JSON object.
std::string json_of(const ToNetworkReport& report);

/// Writes a report as a few lines for a terminal.
std::string summary_of(const ToNetworkReport& report);

}  // namespace slamd::replay
