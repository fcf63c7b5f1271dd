#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/stamp.hpp"
#include "drivers/livox/conversation.hpp"
#include "drivers/livox/device_host.hpp"
#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"
#include "drivers/livox/sdk1_setup.hpp"

namespace slamd::livox {

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

/// The host's side of SDK1 (livox-sdk1.md §3, §4) for one device.
///
/// It answers the broadcast of its device, holds the device by heartbeats, brings it into its mode,
/// configures it one command after the other and starts it; it notices silence, restarts and
/// refusals, and begins again by itself each time. A device that another host holds does not look
/// for one: kNotSeen may mean that, kHeldByOther does.
/// Real-time: never allocates; O(bytes); one thread.
class Sdk1Host final : public DeviceHost {
 public:
  static constexpr std::uint16_t kBroadcastPort = 55000;
  static constexpr Duration kAnswerWait = std::chrono::milliseconds{500};
  static constexpr Duration kHeartbeatEvery = std::chrono::milliseconds{800};
  static constexpr Duration kLostAfter = std::chrono::seconds{3};
  /// A broadcast may still be on its way while the device takes the handshake.
  static constexpr Duration kStaleBroadcast = std::chrono::seconds{1};

  explicit Sdk1Host(const Sdk1HostConfig& config);

  void receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) override;
  void advance(Stamp now, HostOutput& out) override;
  void stop(HostOutput& out) override;
  void start() override;
  void set_again(Stamp now, HostOutput& out) override;
  void set_interfaces(const HostInterfaces& interfaces) override { conversation_.set_interfaces(interfaces); }

  /// Brings the device into a mode, now or once it is connected. Power saving and standby stop it.
  void set_mode(Sdk1Mode mode, Stamp now, HostOutput& out);

  /// Tells the device the time of the last PPS edge; to be called 10 to 500 ms after each edge.
  /// Errors: false, and nothing is sent, unless a device is connected.
  bool set_utc(const Sdk1Utc& utc, HostOutput& out);

  Sdk1HostState state() const { return state_; }
  std::string_view state_name() const override;
  bool is_connected() const override;
  bool is_sampling() const override { return state_ == Sdk1HostState::kSampling; }
  Endpoint device() const override { return conversation_.device(); }
  const DeviceCode& code() const { return conversation_.code(); }
  const std::optional<Sdk1Extrinsic>& extrinsic() const { return extrinsic_; }
  const std::array<std::uint8_t, 4>& firmware() const { return firmware_; }
  std::uint32_t status_code() const { return status_.value_or(0); }
  const HostCounters& counters() const { return conversation_.counters(); }

 private:
  void take_frame(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out);
  void take_broadcast(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out);
  void take_utc_ack(const Sdk1Frame& frame, HostOutput& out);
  void take_handshake_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void take_heartbeat_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void take_step_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void take_mode_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out);
  void note_state(Sdk1WorkState work, Stamp now, HostOutput& out);
  void note_status(std::uint32_t code, HostOutput& out);
  void handshake(Stamp now, HostOutput& out);
  void heartbeat(Stamp now, HostOutput& out);
  void ask_for_mode(Stamp now, HostOutput& out);
  void begin_step(Sdk1Step step, Stamp now, HostOutput& out);
  void send_step(Stamp now, HostOutput& out);
  void repeat_unanswered(Stamp now, HostOutput& out);
  void search();
  std::uint32_t send(Sdk1Command command, std::span<const std::byte> payload, HostOutput& out);
  void tell_result(std::uint32_t result, Sdk1Command command, HostOutput& out) const {
    conversation_.tell(HostEventKind::kCommandFailed, out, result, words_of(command));
  }

  Sdk1HostConfig config_;
  Conversation conversation_;
  Sdk1HostState state_ = Sdk1HostState::kSearching;
  Sdk1Mode mode_ = Sdk1Mode::kNormal;
  Sdk1Step step_ = Sdk1Step::kDone;
  bool asked_mode_ = false;  // the command that waits for its answer sets the mode
  Stamp next_heartbeat_{};
  Stamp connected_since_{};
  bool disowned_ = false;  // it answers heartbeats, but not as this host's
  std::optional<Sdk1WorkState> work_;
  std::optional<std::uint32_t> progress_;
  std::optional<std::uint32_t> status_;
  std::optional<Sdk1Extrinsic> extrinsic_;
  std::array<std::uint8_t, 4> firmware_{};
  bool told_held_ = false;
};

/// Names a state as reports and health spell it.
std::string_view name_of(Sdk1HostState state);

}  // namespace slamd::livox
