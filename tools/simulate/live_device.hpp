#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/emulation/networked_device.hpp"
#include "tools/emulation/sdk1_device.hpp"
#include "tools/simulate/live_drive.hpp"

namespace slamd::simulate {

/// What an emulated device is, beside what its drive says.
struct DeviceOptions {
  std::string code;                // its broadcast code or serial number; empty: one that a document shows
  bool pps = false;                // an Avia: a PPS line that beats with the wall clock
  livox::Sdk1Extrinsic extrinsic;  // as it is stored in the device
};

/// The Livox of a live drive as a device on the network: a host finds, sets and starts it, and gets its packets.
class LiveDevice final : public PacketOutlet {
 public:
  /// `say` hears what becomes of it. Errors: TransportError when one of its ports is taken.
  LiveDevice(const Drive& drive, const DeviceOptions& options, replay::SendClock& clock,
             const std::function<void(const std::string&)>& say);

  /// Answers its hosts, and sends a packet if one wants it, stamped as the device's clock stands.
  void send(std::span<const std::byte> payload, Duration wall_minus_recorded) override;

  DeviceReport report() const;

  /// Says how many packets went to a host, and how many no host wanted or the network did not take.
  std::string summary() const;

 private:
  std::span<const std::byte> stamped(std::span<const std::byte> payload, Duration wall_minus_recorded);

  replay::SendClock& clock_;
  Duration utc_minus_own_;
  emulation::Sdk1Device* avia_ = nullptr;  // the device, where it is one
  emulation::NetworkedDevice device_;
  std::vector<std::byte> packet_;  // scratch
  Duration next_serving_{};
  std::uint64_t sent_ = 0;
  std::uint64_t unwanted_ = 0;
};

}  // namespace slamd::simulate
