#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "tools/emulation/networked_device.hpp"
#include "tools/simulate/live_drive.hpp"

namespace slamd::simulate {

/// The Livox of a live drive as a device on the network: a host finds, sets and starts it, and gets its packets.
class LiveDevice final : public PacketOutlet {
 public:
  /// `code`: its broadcast code or serial number; empty: one that a document shows. `say` hears what becomes of it.
  /// Errors: TransportError when one of its ports is taken.
  LiveDevice(const Drive& drive, const std::string& code, replay::SendClock& clock,
             const std::function<void(const std::string&)>& say);

  /// Answers its hosts, and sends a packet if one wants it.
  void send(std::span<const std::byte> payload) override;

  /// Says how many packets went to a host, and how many no host wanted or the network did not take.
  std::string summary() const;

 private:
  replay::SendClock& clock_;
  emulation::NetworkedDevice device_;
  Duration next_serving_{};
  std::uint64_t sent_ = 0;
  std::uint64_t unwanted_ = 0;
};

}  // namespace slamd::simulate
