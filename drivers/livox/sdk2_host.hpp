#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/stamp.hpp"
#include "drivers/livox/conversation.hpp"
#include "drivers/livox/device_host.hpp"
#include "drivers/livox/sdk2_frame.hpp"
#include "drivers/livox/sdk2_setup.hpp"

namespace slamd::livox {

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

/// The host's side of SDK2 (livox-sdk2.md §3) for one device.
///
/// It looks for its device, reads what it is set to, has points and inertial samples sent here,
/// starts it, and asks for its state once a second: SDK2 has no heartbeat, and how often the device
/// tells its state by itself is not documented. It notices silence, restarts, and another host that
/// has the points sent to itself, and begins again by itself.
/// Real-time: never allocates; O(bytes); one thread.
class Sdk2Host final : public DeviceHost {
 public:
  static constexpr std::uint16_t kDiscoveryPort = 56000;  // of both sides
  static constexpr Duration kDiscoverEvery = std::chrono::seconds{1};
  static constexpr Duration kAnswerWait = std::chrono::seconds{1};
  static constexpr Duration kAskEvery = std::chrono::seconds{1};
  static constexpr Duration kLostAfter = std::chrono::milliseconds{3500};

  explicit Sdk2Host(const Sdk2HostConfig& config);

  void receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) override;
  void advance(Stamp now, HostOutput& out) override;
  void stop(HostOutput& out) override;
  void start() override;
  void set_again(Stamp now, HostOutput& out) override;
  void set_interfaces(const HostInterfaces& interfaces) override { conversation_.set_interfaces(interfaces); }

  /// Has the device sample, or rest; now or once it is connected.
  void set_sampling(bool sampling, Stamp now, HostOutput& out);

  /// Tells the device the time of the last PPS edge.
  /// Errors: false, and nothing is sent, unless a device is connected.
  bool set_gps_time(std::uint64_t utc_ns, HostOutput& out);

  Sdk2HostState state() const { return state_; }
  std::string_view state_name() const override;
  bool is_connected() const override;
  bool is_sampling() const override { return state_ == Sdk2HostState::kSampling; }
  Endpoint device() const override { return conversation_.device(); }
  const DeviceCode& serial_number() const { return conversation_.code(); }
  const std::optional<Sdk1Extrinsic>& attitude() const { return attitude_; }
  std::optional<double> temperature_c() const { return temperature_c_; }
  const HostCounters& counters() const { return conversation_.counters(); }

 private:
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
  void begin_step(Sdk2Step step, Stamp now, HostOutput& out);
  void send_step(Stamp now, HostOutput& out);
  void settle(Stamp now, HostOutput& out);
  void repeat_unanswered(Stamp now, HostOutput& out);
  void search();
  std::uint8_t work_mode() const { return sampling_ ? 1 : 2; }
  std::uint32_t send(Sdk2Command command, std::span<const std::byte> payload, HostOutput& out);

  Sdk2HostConfig config_;
  Conversation conversation_;
  Sdk2HostState state_ = Sdk2HostState::kSearching;
  bool sampling_ = true;
  Sdk2Step step_ = Sdk2Step::kDone;
  std::uint32_t state_asked_ = 0;
  Stamp next_ask_{};
  Stamp next_discovery_{};
  std::optional<std::uint8_t> work_;
  std::optional<std::uint8_t> sync_;
  std::optional<std::uint32_t> power_ups_;
  std::optional<std::uint32_t> firmware_;
  std::uint32_t health_ = 0;
  std::uint32_t other_host_ = 0;  // where the points went when the device was found; 0: here, or nowhere
  std::optional<Sdk1Extrinsic> attitude_;
  std::optional<double> temperature_c_;
};

/// Names a state as reports and health spell it.
std::string_view name_of(Sdk2HostState state);

}  // namespace slamd::livox
