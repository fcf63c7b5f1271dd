#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/stamp.hpp"
#include "tools/replay/recording.hpp"

namespace slamd::replay {

/// Where a recording is re-sent to, and how fast.
struct ToNetworkOptions {
  std::uint32_t address = 0;        // host order
  std::uint16_t data_port = 0;      // 0: the one that each packet was recorded with
  std::uint16_t position_port = 0;  // Velodyne position packets, a Mid-360's inertial ones; 0: as above
  double speed = 1.0;               // 0: as fast as kBurst packets and a pause go

  // Rows of the recording's imu.csv: one a datagram, or lines of a pseudo terminal. Neither: they are left out.
  std::uint32_t imu_address = 0;
  std::uint16_t imu_port = 0;
  std::filesystem::path imu_terminal;
};

/// Reads HOST[:DATA_PORT[:POSITION_PORT]]. Errors: cli::UsageError.
void parse_destination(const std::string& text, ToNetworkOptions& options);

/// Reads udp:HOST:PORT or pty:LINKPATH. Errors: cli::UsageError.
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

  std::uint64_t foreign = 0;        // packets to other ports, and refused frames: not sent
  std::uint64_t imu_unheard = 0;    // rows that nobody read from the terminal
  std::uint64_t imu_outside = 0;    // rows more than kImuMargin before the first packet or after the last
  std::uint64_t imu_refused = 0;    // bad rows of the file
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

/// Sends a recording's packets to the network with their timing: each at an absolute deadline by its capture stamp; the
/// rows of imu.csv among them by their own stamps, which stay as they are.
/// Errors: RecordingError; std::runtime_error for what the network refuses.
ToNetworkReport send_to_network(const Recording& recording,
                                const ToNetworkOptions& options,
                                SendClock& clock,
                                const std::function<bool()>& stopped,
                                const std::function<void(double share)>& progress);

/// Writes a report as one JSON object.
std::string json_of(const ToNetworkReport& report);

/// Writes a report as a few lines for a terminal.
std::string summary_of(const ToNetworkReport& report);

}  // namespace slamd::replay
