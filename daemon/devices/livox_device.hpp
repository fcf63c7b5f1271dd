#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/devices/device_words.hpp"
#include "daemon/devices/utc_feed.hpp"
#include "drivers/livox/device_host.hpp"
#include "drivers/livox/sdk1_host.hpp"
#include "drivers/transport/datagram_socket.hpp"

namespace slamd::devices {

/// Makes the host's side for the device that the configuration names.
std::unique_ptr<livox::DeviceHost> make_host(const configuration::Configuration& configuration);

/// How long a device that says it samples may send nothing.
inline constexpr Duration kNoDataAfter = std::chrono::seconds(3);

/// Tells when a device that says it samples has sent nothing for too long; once in so long.
class DataWatch {
 public:
  bool is_overdue(bool samples, Stamp data, Stamp now) {
    if (!samples || data > since_) {
      since_ = samples ? data : now;
    }
    const bool overdue = now - since_ > kNoDataAfter;
    since_ = overdue ? now : since_;
    return overdue;
  }

 private:
  Stamp since_{};
};

/// Keeps a Livox: finds it, sets it, has it send here, and all of that again whenever it was lost. Its data go past this,
/// to the receive thread.
/// Threads: housekeeping; run_once() at least every 100 ms, and when an fd is readable.
class LivoxDevice {
 public:
  /// Hears what is new: its cause (repetitions have the same), and a sentence.
  using Say = std::function<void(const std::string& cause, const std::string& sentence)>;

  /// Binds the ports. Errors: transport::TransportError.
  explicit LivoxDevice(const configuration::Configuration& configuration);

  std::vector<int> fds() const;

  /// data: when its newest data came.
  void run_once(Stamp now, Stamp data, const Say& say);

  /// Tells the device the UTC of a receiver's newest fix, when it is a new second's, and that is configured.
  void tell_time(const sensor::GnssFix& fix, Stamp now);

  /// Stops the device and lets it go.
  void stop(const Say& say);

  /// Where its data come from, in host order; 0 while no device is this host's.
  std::uint32_t address() const { return host_->is_connected() ? host_->device().address : 0; }

  /// What is wrong with it, or what it is busy with; empty: it samples, and is well.
  std::string cause() const { return words_.cause(host_->is_sampling(), host_->state_name()); }

 private:
  void look_at_interfaces();
  void hand_out(const Say& say);
  void send_out();

  std::unique_ptr<livox::DeviceHost> host_;
  std::vector<std::unique_ptr<transport::DatagramSocket>> sockets_;
  livox::HostOutput out_;
  DeviceWords words_;
  DataWatch data_watch_;
  geometry::Se3 T_base_lidar_;
  std::string told_extrinsic_;  // whose, and which
  livox::Sdk1Host* timed_ = nullptr;  // the host, where it is to be told the time
  UtcFeed utc_;
  bool time_was_set_ = false;  // since it was connected
};

}  // namespace slamd::devices
