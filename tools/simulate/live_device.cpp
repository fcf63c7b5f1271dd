#include "tools/simulate/live_device.hpp"

#include <ctime>
#include <memory>
#include <optional>

#include "core/base/bytes.hpp"
#include "drivers/transport/interfaces.hpp"
#include "tools/emulation/sdk2_device.hpp"
#include "tools/simulate/livox_lidar.hpp"
#include "tools/simulate/scene.hpp"
#include "tools/simulate/wire.hpp"

namespace slamd::simulate {

namespace {

constexpr Duration kServeEvery = std::chrono::milliseconds(5);

std::uint32_t own_address() {
  for (const transport::Interface& interface : transport::interfaces()) {
    if (interface.broadcasts) {
      return interface.address;
    }
  }
  return 0;
}

std::unique_ptr<emulation::Device> device_of(const Drive& drive, const DeviceOptions& options, Duration utc_minus_own, Stamp power_up,
                                             emulation::Sdk1Device*& avia) {
  const std::string& code = options.code;
  if (drive.lidar == LidarKind::kLivoxAvia) {
    emulation::Sdk1DeviceConfig config;
    config.extrinsic = options.extrinsic;
    config.utc_minus_own = options.pps ? std::optional(utc_minus_own) : std::nullopt;
    config.code = code.empty() ? config.code : livox::DeviceCode::of(code);
    config.coordinate = drive.spherical ? 1 : 0;
    config.return_mode = static_cast<std::uint8_t>(drive.returns);
    auto device = std::make_unique<emulation::Sdk1Device>(config, power_up);
    avia = device.get();
    return device;
  }
  emulation::Sdk2DeviceConfig config;
  config.serial_number = code.empty() ? config.serial_number : livox::DeviceCode::of(code);
  config.attitude = options.extrinsic;
  config.address = own_address();
  config.power_ups = static_cast<std::uint32_t>(std::time(nullptr));  // more with each start, as a device's
  return std::make_unique<emulation::Sdk2Device>(config, power_up);
}

}  // namespace

LiveDevice::LiveDevice(const Drive& drive, const DeviceOptions& options, replay::SendClock& clock,
                       const std::function<void(const std::string&)>& say)
    : clock_(clock),
      utc_minus_own_(std::chrono::system_clock::now().time_since_epoch() - clock.now()),
      device_(device_of(drive, options, utc_minus_own_, Stamp(clock.now()), avia_),
              [say](const std::string& text) { say("the device " + text); }) {}

void LiveDevice::send(std::span<const std::byte> payload, Duration wall_minus_recorded) {
  const Duration now = clock_.now();
  if (now >= next_serving_) {
    next_serving_ = now + kServeEvery;
    device_.serve(Stamp(now));
  }
  const emulation::Stream stream = is_imu(wire_of(payload)) ? emulation::Stream::kImu : emulation::Stream::kPoints;
  ++(device_.send(stream, stamped(payload, wall_minus_recorded)) ? sent_ : unwanted_);
}

/// A packet is simulated as of a device that counts from its power-up.
std::span<const std::byte> LiveDevice::stamped(std::span<const std::byte> payload, Duration wall_minus_recorded) {
  if (avia_ == nullptr || wire_of(payload) == Wire::kOther) {
    return payload;
  }
  packet_.assign(payload.begin(), payload.end());
  const Duration since_begin{static_cast<std::int64_t>(load_le<std::uint64_t>(payload, 10) - LivoxLidar::kPowerUp_ns)};
  avia_->stamp(packet_, stamp_at(0.0) + since_begin + wall_minus_recorded - utc_minus_own_);
  return packet_;
}

DeviceReport LiveDevice::report() const {
  return {sent_, unwanted_, avia_ == nullptr ? 0 : avia_->utc_told(), avia_ == nullptr ? 0 : avia_->utc_unused()};
}

std::string LiveDevice::summary() const {
  return "the device sent " + std::to_string(sent_) + " packets, and kept " + std::to_string(unwanted_) +
         " that no host wanted";
}

}  // namespace slamd::simulate
