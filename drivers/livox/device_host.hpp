#pragma once

#include <span>
#include <string_view>

#include "core/base/stamp.hpp"
#include "drivers/livox/conversation.hpp"
#include "drivers/livox/host_event.hpp"

namespace slamd::livox {

/// The host's side of a protocol for one device, without thread, socket or clock: bytes and time go in, datagrams and
/// events come out.
class DeviceHost {
 public:
  virtual ~DeviceHost() = default;

  /// Takes a datagram from one of the host's ports. Any bytes may be given; from is its sender.
  virtual void receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) = 0;

  /// Lets time pass: call it at least every 100 ms.
  virtual void advance(Stamp now, HostOutput& out) = 0;

  /// Stops the device and lets it go.
  virtual void stop(HostOutput& out) = 0;

  /// Goes on after stop().
  virtual void start() = 0;

  /// Sets a device again that says it samples, but whose data do not arrive.
  virtual void set_again(Stamp now, HostOutput& out) = 0;

  /// The addresses that this host has now; counts when a device is next found.
  virtual void set_interfaces(const HostInterfaces& interfaces) = 0;

  /// Where the conversation stands, as reports and health spell it.
  virtual std::string_view state_name() const = 0;

  /// The device is this host's; and sends data.
  virtual bool is_connected() const = 0;
  virtual bool is_sampling() const = 0;

  virtual Endpoint device() const = 0;
};

}  // namespace slamd::livox
