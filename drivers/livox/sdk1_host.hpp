#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/stamp.hpp"
#include "drivers/livox/host_event.hpp"
#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::livox {

enum class Sdk1Mode : std::uint8_t { kNormal = 1, kPowerSaving = 2, kStandby = 3 };

/// What one device is to do for this host.
struct Sdk1HostConfig {
  DeviceCode device;               // empty: the first that looks for a host
  std::uint32_t host_address = 0;  // host order
  std::uint32_t netmask = 0xFFFFFF00;
  std::uint16_t command_port = 55501;
  std::uint16_t data_port = 56001;
  std::uint16_t imu_port = 56001;
  std::uint8_t coordinate = 0;  // 0 cartesian, 1 spherical
  std::optional<std::uint8_t> return_mode;  // 0 first, 1 strongest, 2 dual, 3 triple; none: as it is
  bool imu = true;
  bool read_extrinsic = true;
};

/// Where the conversation with a device stands.
enum class Sdk1HostState : std::uint8_t {
  kSearching,     // waits for a broadcast
  kHandshaking,   // has answered one
  kWaiting,       // connected; the device is not yet in its work state
  kConfiguring,   // one command after the other
  kSampling,      // nothing to do but heartbeats
  kResting,       // as asked for: power saving or standby
  kStopped,       // by stop(); start() goes on
};

/// The host's side of SDK1 (livox-sdk1.md §3, §4) for one device, without thread, socket or clock:
/// bytes and time go in, datagrams and events come out.
///
/// It answers the broadcast of its device, holds the device by heartbeats, brings it into its mode,
/// configures it one command after the other and starts it; it notices silence, restarts and
/// refusals, and begins again by itself each time. A device that another host holds does not look
/// for one: kNotSeen may mean that, kHeldByOther does.
/// Real-time: never allocates; O(bytes); one thread.
class Sdk1Host {
 public:
  static constexpr std::uint16_t kBroadcastPort = 55000;
  static constexpr Duration kAnswerWait = std::chrono::milliseconds{500};
  static constexpr Duration kHeartbeatEvery = std::chrono::milliseconds{800};
  static constexpr Duration kLostAfter = std::chrono::seconds{3};
  static constexpr Duration kNotSeenAfter = std::chrono::seconds{5};
  /// A broadcast may still be on its way while the device takes the handshake.
  static constexpr Duration kStaleBroadcast = std::chrono::seconds{1};
  static constexpr int kTries = 3;

  explicit Sdk1Host(const Sdk1HostConfig& config) : config_(config) {}

  /// Takes a datagram from the broadcast port or the command port. Any bytes may be given; from is
  /// its sender.
  void receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out);

  /// Lets time pass: call it at least every 100 ms.
  void advance(Stamp now, HostOutput& out);

  /// Stops the device and lets it go.
  void stop(Stamp now, HostOutput& out);

  /// Goes on after stop().
  void start();

  /// Brings the device into a mode, now or once it is connected. Power saving and standby stop it.
  void set_mode(Sdk1Mode mode, Stamp now, HostOutput& out);

  /// Tells the device the time of the last PPS edge; to be called 10 to 500 ms after each edge.
  /// Errors: false, and nothing is sent, unless a device is connected.
  bool set_utc(const Sdk1Utc& utc, HostOutput& out);

  Sdk1HostState state() const { return state_; }
  Endpoint device() const { return device_; }
  const DeviceCode& code() const { return code_; }
  const std::optional<Sdk1Extrinsic>& extrinsic() const { return extrinsic_; }
  const std::array<std::uint8_t, 4>& firmware() const { return firmware_; }
  std::uint32_t status_code() const { return status_.value_or(0); }
  const HostCounters& counters() const { return counters_; }

 private:
  /// What is done to a device before it samples, in this order.
  enum class Step : std::uint8_t { kDeviceInfo, kCoordinate, kReturnMode, kImuRate, kExtrinsic, kStart, kDone };

  bool connected() const;
  void take_frame(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out);
  void take_broadcast(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out);
  void take_handshake_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void take_heartbeat_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void take_step_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void take_mode_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void note_state(Sdk1WorkState work, Stamp now, HostOutput& out);
  void note_status(std::uint32_t code, HostOutput& out);
  void handshake(Stamp now, HostOutput& out);
  void heartbeat(Stamp now, HostOutput& out);
  void ask_for_mode(Stamp now, HostOutput& out);
  void begin_step(Step step, Stamp now, HostOutput& out);
  void next_step(Stamp now, HostOutput& out);
  void send_step(Stamp now, HostOutput& out);
  bool wanted(Step step) const;
  void repeat_unanswered(Stamp now, HostOutput& out);
  void search();
  std::uint16_t send(Sdk1Command command, std::span<const std::byte> payload, HostOutput& out);
  void tell(HostEventKind kind, HostOutput& out, std::uint32_t value = 0, const char* command = "") const;

  Sdk1HostConfig config_;
  Sdk1HostState state_ = Sdk1HostState::kSearching;
  Sdk1Mode mode_ = Sdk1Mode::kNormal;
  Endpoint device_;
  DeviceCode code_;
  Step step_ = Step::kDone;
  std::uint16_t last_sequence_ = 0;
  std::uint16_t asked_ = 0;  // number of the command whose answer is waited for; 0: of none
  bool asked_mode_ = false;  // that command sets the mode
  int tries_ = 0;
  Stamp ask_again_{};
  Stamp next_heartbeat_{};
  Stamp heard_{};
  Stamp connected_since_{};
  std::optional<Stamp> searching_since_;
  bool disowned_ = false;  // it answers heartbeats, but not as this host's
  std::optional<Sdk1WorkState> work_;
  std::optional<std::uint32_t> progress_;
  std::optional<std::uint32_t> status_;
  std::optional<Sdk1Extrinsic> extrinsic_;
  std::array<std::uint8_t, 4> firmware_{};
  std::optional<DeviceCode> told_wrong_subnet_;
  bool told_held_ = false;
  bool told_not_seen_ = false;
  HostCounters counters_;
};

/// Names a state as reports and health spell it.
std::string_view name_of(Sdk1HostState state);

}  // namespace slamd::livox
