#pragma once

#include <array>
#include <optional>

#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"
#include "drivers/livox/status_code.hpp"
#include "tools/emulation/device.hpp"

namespace slamd::emulation {

/// What an emulated Avia is, and what its drive is simulated in: it takes no other coordinates and returns.
struct Sdk1DeviceConfig {
  livox::DeviceCode code = livox::DeviceCode::of("3JEDK380010Z391");
  std::uint8_t type = 7;
  std::array<std::uint8_t, 4> firmware{11, 6, 0, 0};
  Duration boots = std::chrono::seconds{1};
  std::uint8_t coordinate = 0;
  std::uint8_t return_mode = 0;
  livox::Sdk1Extrinsic extrinsic;  // as it is stored
  /// The wall clock minus the device's, where it has a PPS line: its edges are whole seconds of UTC.
  std::optional<Duration> utc_minus_own;
};

/// Where an emulated Avia stands with hosts.
enum class Sdk1DeviceState : std::uint8_t {
  kLooking,   // broadcasts once a second
  kHeld,      // by the host whose handshake it took
  kSampling,  // held, and sends its data there
};

/// An Avia as its hosts see it (livox-sdk1.md §3, §4, §7): it looks for a host by broadcasts, belongs to the first that
/// shakes hands and refuses all others, does what that one commands, and gives it up when its heartbeats stop. Its stamps
/// count from its power-up, with a PPS line from the last edge, and once it was told an edge's UTC in time they are a date.
class Sdk1Device final : public Device {
 public:
  static constexpr std::uint16_t kCommandPort = 65000;
  static constexpr std::uint16_t kPointPort = 60001;
  static constexpr std::uint16_t kImuPort = 60003;
  static constexpr std::uint16_t kBroadcastPort = 55000;  // of hosts
  static constexpr Duration kBroadcastEvery = std::chrono::seconds{1};
  static constexpr Duration kGivesUpAfter = std::chrono::seconds{5};
  static constexpr Duration kStatusEvery = std::chrono::milliseconds{100};
  /// When after a PPS edge it takes the UTC.
  static constexpr Duration kUtcFrom = std::chrono::milliseconds{10};
  static constexpr Duration kUtcUntil = std::chrono::milliseconds{500};

  Sdk1Device(const Sdk1DeviceConfig& config, Stamp power_up)
      : config_(config), power_up_(power_up), extrinsic_(config.extrinsic) {}

  void receive(std::span<const std::byte> datagram, livox::Endpoint from, std::uint16_t to_port, Stamp now,
               DeviceOutput& out) override;
  void advance(Stamp now, DeviceOutput& out) override;
  std::vector<std::uint16_t> ports() const override { return {kCommandPort, kPointPort, kImuPort}; }
  std::uint16_t source_port(Stream stream) const override { return stream == Stream::kPoints ? kPointPort : kImuPort; }
  std::optional<livox::Endpoint> destination(Stream stream) const override;

  /// Sets its status code, which it pushes ten times a second while the code says that something is wrong.
  void set_status(std::uint32_t code) { status_ = code; }

  /// Writes its status, and its time of a data packet's first point, into the packet's header.
  void stamp(std::span<std::byte> packet, Stamp taken) const;

  Sdk1DeviceState state() const { return state_; }
  livox::Sdk1WorkState work() const { return work_; }
  livox::TimeSync time_sync() const { return sync_; }
  const std::optional<livox::Sdk1Utc>& utc() const { return utc_; }

  /// How often it was told the UTC, and how often it could not use it: without PPS, or not in time after an edge.
  std::uint64_t utc_told() const { return utc_told_; }
  std::uint64_t utc_unused() const { return utc_unused_; }

 private:
  void take(const livox::Sdk1Frame& frame, livox::Endpoint from, Stamp now, DeviceOutput& out);
  void take_handshake(const livox::Sdk1Frame& frame, livox::Endpoint from, Stamp now, DeviceOutput& out);
  livox::Payload answer_to(const livox::Sdk1Frame& frame, Stamp now, DeviceOutput& out);
  livox::Payload heartbeat_answer(Stamp now);
  std::uint8_t sample(std::span<const std::byte> payload, DeviceOutput& out);
  std::uint8_t set_mode(std::span<const std::byte> payload, DeviceOutput& out);
  std::uint8_t set_imu_rate(std::span<const std::byte> payload);
  std::uint8_t set_extrinsic(std::span<const std::byte> payload);
  std::uint8_t set_utc(std::span<const std::byte> payload, Stamp now, DeviceOutput& out);
  Stamp edge_before(Stamp now) const;
  std::uint32_t status() const;
  void give_up(const char* why, DeviceOutput& out);
  void send(livox::Sdk1FrameType type, std::uint16_t number, livox::Sdk1Command command, const livox::Payload& payload,
            livox::Endpoint to, DeviceOutput& out) const;

  Sdk1DeviceConfig config_;
  Stamp power_up_;
  Sdk1DeviceState state_ = Sdk1DeviceState::kLooking;
  livox::Sdk1WorkState work_ = livox::Sdk1WorkState::kInitialising;
  livox::Sdk1Handshake host_;
  std::uint16_t messages_ = 0;
  bool sends_imu_ = true;
  std::uint32_t status_ = 0;
  livox::Sdk1Extrinsic extrinsic_;
  livox::TimeSync sync_ = livox::TimeSync::kNone;
  std::optional<livox::Sdk1Utc> utc_;  // as it was last told
  Duration told_minus_own_{};          // kGps: the clock that it was told, minus its own
  std::uint64_t utc_told_ = 0;
  std::uint64_t utc_unused_ = 0;
  Stamp heard_{};
  Stamp next_broadcast_{};
  Stamp next_status_{};
};

}  // namespace slamd::emulation
