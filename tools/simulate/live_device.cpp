#include "tools/simulate/live_device.hpp"

#include <ctime>
#include <memory>

#include "drivers/transport/interfaces.hpp"
#include "tools/emulation/sdk1_device.hpp"
#include "tools/emulation/sdk2_device.hpp"
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

std::unique_ptr<emulation::Device> device_of(const Drive& drive, const std::string& code, Stamp power_up) {
  if (drive.lidar == LidarKind::kLivoxAvia) {
    emulation::Sdk1DeviceConfig config;
    config.code = code.empty() ? config.code : livox::DeviceCode::of(code);
    config.coordinate = drive.spherical ? 1 : 0;
    config.return_mode = static_cast<std::uint8_t>(drive.returns);
    return std::make_unique<emulation::Sdk1Device>(config, power_up);
  }
  emulation::Sdk2DeviceConfig config;
  config.serial_number = code.empty() ? config.serial_number : livox::DeviceCode::of(code);
  config.address = own_address();
  config.power_ups = static_cast<std::uint32_t>(std::time(nullptr));  // more with each start, as a device's
  return std::make_unique<emulation::Sdk2Device>(config, power_up);
}

}  // namespace

LiveDevice::LiveDevice(const Drive& drive, const std::string& code, replay::SendClock& clock,
                       const std::function<void(const std::string&)>& say)
    : clock_(clock),
      device_(device_of(drive, code, Stamp(clock.now())), [say](const std::string& text) { say("the device " + text); }) {}

void LiveDevice::send(std::span<const std::byte> payload) {
  const Duration now = clock_.now();
  if (now >= next_serving_) {
    next_serving_ = now + kServeEvery;
    device_.serve(Stamp(now));
  }
  const emulation::Stream stream = is_imu(wire_of(payload)) ? emulation::Stream::kImu : emulation::Stream::kPoints;
  ++(device_.send(stream, payload) ? sent_ : unwanted_);
}

std::string LiveDevice::summary() const {
  return "the device sent " + std::to_string(sent_) + " packets, and kept " + std::to_string(unwanted_) +
         " that no host wanted";
}

}  // namespace slamd::simulate
