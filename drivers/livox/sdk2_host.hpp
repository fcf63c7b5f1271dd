#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/stamp.hpp"
#include "drivers/livox/host_event.hpp"
#include "drivers/livox/sdk2_frame.hpp"

namespace slamd::livox {

/// What one device is to do for this host; the ports are the SDK's for a Mid-360.
struct Sdk2HostConfig {
  DeviceCode serial_number;        // empty: the first that answers
  std::uint32_t host_address = 0;  // host order
  std::uint32_t netmask = 0xFFFFFF00;
  std::uint16_t state_port = 56201;
  std::uint16_t point_port = 56301;
  std::uint16_t imu_port = 56401;
  std::uint8_t point_type = 1;  // 1 of 32 bits, 2 of 16 bits, 3 spherical
  std::optional<std::uint8_t> scan_pattern;
  bool imu = true;
  /// Whether to take a device that is set to send to another host. They come so from the factory.
  bool take_over = true;
};

/// Where the conversation with a device stands.
enum class Sdk2HostState : std::uint8_t {
  kSearching,    // asks everybody, once a second
  kReading,      // has found the device, and asks what it is set to
  kConfiguring,  // one parameter after the other
  kWaiting,      // configured; the device is not yet in its work state
  kSampling,
  kResting,      // as asked for
  kHeld,         // it sends to another host, and is left to it
  kStopped,      // by stop(); start() goes on
};

/// The host's side of SDK2 (livox-sdk2.md §3) for one device, without thread, socket or clock: bytes
/// and time go in, datagrams and events come out.
///
/// It looks for its device, reads what it is set to, has points and inertial samples sent here,
/// starts it, and asks for its state once a second: SDK2 has no heartbeat, and how often the device
/// tells its state by itself is not documented. It notices silence, restarts, and another host that
/// has the points sent to itself, and begins again by itself.
/// Real-time: never allocates; O(bytes); one thread.
class Sdk2Host {
 public:
  static constexpr std::uint16_t kDiscoveryPort = 56000;  // of both sides
  static constexpr std::uint16_t kCommandPort = 56101;    // where the host hears answers
  static constexpr Duration kDiscoverEvery = std::chrono::seconds{1};
  static constexpr Duration kAnswerWait = std::chrono::seconds{1};
  static constexpr Duration kAskEvery = std::chrono::seconds{1};
  static constexpr Duration kLostAfter = std::chrono::milliseconds{3500};
  static constexpr Duration kNotSeenAfter = std::chrono::seconds{5};
  static constexpr int kTries = 3;

  explicit Sdk2Host(const Sdk2HostConfig& config) : config_(config) {}

  /// Takes a datagram from the discovery, command or state port. Any bytes may be given; from is its
  /// sender.
  void receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out);

  /// Lets time pass: call it at least every 100 ms.
  void advance(Stamp now, HostOutput& out);

  /// Puts the device to rest and lets it go.
  void stop(HostOutput& out);

  /// Goes on after stop().
  void start();

  /// Has the device sample, or rest; now or once it is connected.
  void set_sampling(bool sampling, Stamp now, HostOutput& out);

  /// Tells the device the time of the last PPS edge.
  /// Errors: false, and nothing is sent, unless a device is connected.
  bool set_gps_time(std::uint64_t utc_ns, HostOutput& out);

  Sdk2HostState state() const { return state_; }
  Endpoint device() const { return device_; }
  const DeviceCode& serial_number() const { return serial_number_; }
  const std::optional<Sdk1Extrinsic>& attitude() const { return attitude_; }
  std::optional<double> temperature_c() const { return temperature_c_; }
  const HostCounters& counters() const { return counters_; }

 private:
  /// What is set in a device, in this order.
  enum class Step : std::uint8_t { kDestinations, kPointType, kScanPattern, kImu, kPointSend, kWorkMode, kDone };

  bool connected() const;
  void take_frame(const Sdk2Frame& frame, Endpoint from, Stamp now, HostOutput& out);
  void take_discovery(const Sdk2Frame& frame, Endpoint from, Stamp now, HostOutput& out);
  void take_answer(const Sdk2Frame& frame, Stamp now, HostOutput& out);
  void take_set_ack(const Sdk2Frame& frame, Stamp now, HostOutput& out);
  void take_values(Sdk2ValueReader values, Stamp now, HostOutput& out);
  void take_value(const Sdk2Value& value, Stamp now, HostOutput& out);
  void note_work_state(std::uint8_t work, Stamp now, HostOutput& out);
  void note_destination(const Sdk2Destination& destination, Stamp now, HostOutput& out);
  void note_power_ups(std::uint32_t count, Stamp now, HostOutput& out);
  void note_health(std::span<const std::byte> codes, HostOutput& out);
  void discover(Stamp now, HostOutput& out);
  void read(Stamp now, HostOutput& out);
  void ask(Stamp now, HostOutput& out);
  void begin_step(Step step, Stamp now, HostOutput& out);
  void send_step(Stamp now, HostOutput& out);
  void settle(Stamp now, HostOutput& out);
  void repeat_unanswered(Stamp now, HostOutput& out);
  void search();
  std::uint8_t work_mode() const { return sampling_ ? 1 : 2; }
  std::uint32_t send(Sdk2Command command, std::span<const std::byte> payload, Endpoint to, HostOutput& out);
  void tell(HostEventKind kind, HostOutput& out, std::uint32_t value = 0, const char* command = "") const;

  Sdk2HostConfig config_;
  Sdk2HostState state_ = Sdk2HostState::kSearching;
  bool sampling_ = true;
  Endpoint device_;
  DeviceCode serial_number_;
  Step step_ = Step::kDone;
  std::uint32_t last_sequence_ = 0;
  std::uint32_t asked_ = 0;  // number of the command whose answer is waited for; 0: of none
  std::uint32_t state_asked_ = 0;
  int tries_ = 0;
  Stamp ask_again_{};
  Stamp next_ask_{};
  Stamp next_discovery_{};
  Stamp heard_{};
  std::optional<Stamp> searching_since_;
  std::optional<std::uint8_t> work_;
  std::optional<std::uint8_t> sync_;
  std::optional<std::uint32_t> power_ups_;
  std::optional<std::uint32_t> firmware_;
  std::uint32_t health_ = 0;
  std::uint32_t other_host_ = 0;  // where the points went when the device was found; 0: here, or nowhere
  std::optional<Sdk1Extrinsic> attitude_;
  std::optional<double> temperature_c_;
  std::optional<DeviceCode> told_wrong_subnet_;
  bool told_not_seen_ = false;
  HostCounters counters_;
};

/// Names a state as reports and health spell it.
std::string_view name_of(Sdk2HostState state);

}  // namespace slamd::livox
