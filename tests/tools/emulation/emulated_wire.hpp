#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "drivers/livox/device_host.hpp"
#include "tests/hex/hex.hpp"
#include "tools/emulation/device.hpp"

namespace slamd::emulation {

using std::chrono::milliseconds;
using std::chrono::seconds;

inline constexpr std::uint32_t kDeviceAddress = 0xC0A80170;  // 192.168.1.112
inline constexpr std::uint32_t kHostAddress = 0xC0A80132;    // 192.168.1.50
inline constexpr std::uint32_t kOtherAddress = 0xC0A80133;

/// A wire between a device under test, frames of the test's own, and slamd's own hosts; and the time.
class EmulatedWire {
 public:
  explicit EmulatedWire(Device& device) : device_(device) {}

  /// A cable that can be pulled.
  bool plugged = true;

  void join(livox::DeviceHost& host, std::uint32_t address) {
    livox::HostInterfaces interfaces;
    interfaces.push_back({address, 0xFFFFFF00});
    host.set_interfaces(interfaces);
    hosts_.push_back({&host, address});
  }

  /// The host's computer dies, and tells nobody.
  void leave(const livox::DeviceHost& host) {
    std::erase_if(hosts_, [&](const Joined& joined) { return joined.host == &host; });
  }

  /// Lets the time pass in steps of 10 ms.
  void run(Duration duration) {
    for (const Stamp end = now + duration; now < end;) {
      now += milliseconds{10};
      device_.advance(now, device_out_);
      from_device();
      for (const Joined& joined : hosts_) {
        joined.host->advance(now, host_out_);
        from_host(joined);
      }
    }
  }

  /// Gives the device bytes, and returns what it has answered first, if anything.
  std::optional<DeviceOutput::Datagram> ask(std::span<const std::byte> datagram, livox::Endpoint from, std::uint16_t port) {
    DeviceOutput out;
    device_.receive(datagram, from, port, now, out);
    news.insert(news.end(), out.news.begin(), out.news.end());
    return out.datagrams.empty() ? std::nullopt : std::optional(out.datagrams.front());
  }

  Stamp now{seconds{1000}};
  std::vector<DeviceOutput::Datagram> sent;  // by the device, by itself or to a host that has joined
  std::vector<std::string> news;
  std::vector<livox::HostEvent> events;

 private:
  struct Joined {
    livox::DeviceHost* host;
    std::uint32_t address;
  };

  void from_device() {
    const DeviceOutput out = device_out_;
    device_out_.clear();
    news.insert(news.end(), out.news.begin(), out.news.end());
    for (const DeviceOutput::Datagram& datagram : out.datagrams) {
      sent.push_back(datagram);
      for (const Joined& joined : hosts_) {
        if (plugged && (datagram.to.address == livox::kEverybody || datagram.to.address == joined.address)) {
          joined.host->receive(datagram.bytes.view(), {kDeviceAddress, datagram.from_port}, now, host_out_);
          from_host(joined);
        }
      }
    }
  }

  void from_host(const Joined& joined) {
    const livox::HostOutput out = host_out_;
    host_out_.clear();
    events.insert(events.end(), out.events.begin(), out.events.end());
    for (const livox::HostOutput::Datagram& datagram : out.datagrams) {
      if (plugged) {
        device_.receive(datagram.bytes.view(), {joined.address, datagram.from_port}, datagram.to.port, now, device_out_);
        from_device();
      }
    }
  }

  Device& device_;
  std::vector<Joined> hosts_;
  DeviceOutput device_out_;
  livox::HostOutput host_out_;
};

}  // namespace slamd::emulation
