#pragma once

#include <map>

#include "drivers/livox/sdk2_frame.hpp"
#include "tools/emulation/device.hpp"

namespace slamd::emulation {

/// What an emulated Mid-360 is. Its drive is simulated in cartesian points of 32 bits: it takes no other.
struct Sdk2DeviceConfig {
  livox::DeviceCode serial_number = livox::DeviceCode::of("47MDL1234567890");
  std::uint8_t type = 9;
  std::uint32_t address = 0;    // its own, host order
  std::uint32_t power_ups = 1;  // how often it was switched on
  livox::Sdk1Extrinsic attitude;  // as it is stored
  Duration boots = std::chrono::seconds{1};
  Duration motor_starts = std::chrono::milliseconds{500};
};

/// What an emulated Mid-360 is at, as the protocol counts.
enum class Sdk2DeviceState : std::uint8_t { kSampling = 1, kIdle = 2, kSelfTest = 5, kMotorStarts = 6 };

/// A Mid-360 as its hosts see it (livox-sdk2.md §3): it answers whoever looks for it, takes parameters from anyone, sends
/// its data where they say, and tells its state there once a second.
class Sdk2Device final : public Device {
 public:
  static constexpr std::uint16_t kDiscoveryPort = 56000;
  static constexpr std::uint16_t kCommandPort = 56100;
  static constexpr std::uint16_t kStatePort = 56200;
  static constexpr std::uint16_t kPointPort = 56300;
  static constexpr std::uint16_t kImuPort = 56400;
  static constexpr Duration kPushEvery = std::chrono::seconds{1};

  Sdk2Device(const Sdk2DeviceConfig& config, Stamp power_up);

  void receive(std::span<const std::byte> datagram, livox::Endpoint from, std::uint16_t to_port, Stamp now,
               DeviceOutput& out) override;
  void advance(Stamp now, DeviceOutput& out) override;
  std::vector<std::uint16_t> ports() const override {
    return {kDiscoveryPort, kCommandPort, kStatePort, kPointPort, kImuPort};
  }
  std::uint16_t source_port(Stream stream) const override { return stream == Stream::kPoints ? kPointPort : kImuPort; }
  std::optional<livox::Endpoint> destination(Stream stream) const override;

  Sdk2DeviceState state() const { return state_; }
  const std::optional<livox::Sdk2GpsTime>& gps_time() const { return gps_time_; }

 private:
  using Bytes = std::vector<std::byte>;

  void take(const livox::Sdk2Frame& frame, livox::Endpoint from, Stamp now, DeviceOutput& out);
  Bytes take_settings(const livox::Sdk2Frame& frame, Stamp now, DeviceOutput& out);
  std::uint8_t set(const livox::Sdk2Value& value);
  Bytes answer_to_question(const livox::Sdk2Frame& frame) const;
  void enter(Sdk2DeviceState state, Stamp now, DeviceOutput& out);
  void follow_work_mode(Stamp now, DeviceOutput& out);
  std::uint8_t setting(livox::Sdk2Key key) const;
  std::optional<livox::Endpoint> endpoint(livox::Sdk2Key key) const;

  Sdk2DeviceConfig config_;
  Stamp power_up_;
  Sdk2DeviceState state_ = Sdk2DeviceState::kSelfTest;
  std::map<livox::Sdk2Key, Bytes> values_;
  std::optional<livox::Sdk2GpsTime> gps_time_;
  std::uint32_t pushes_ = 0;
  Stamp entered_{};
  Stamp next_push_{};
};

}  // namespace slamd::emulation
