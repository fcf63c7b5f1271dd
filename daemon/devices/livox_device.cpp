#include "daemon/devices/livox_device.hpp"

#include <optional>
#include <utility>

#include "daemon/devices/extrinsic_words.hpp"
#include "drivers/livox/sdk2_host.hpp"
#include "drivers/transport/interfaces.hpp"

namespace slamd::devices {

using configuration::Configuration;
using configuration::DeviceCoordinates;
using configuration::DeviceReturns;
using configuration::LidarModel;
using transport::DatagramSocket;

namespace {

/// Housekeeping has other things to do, whatever somebody floods the ports with.
constexpr int kMostAtOnce = 32;

livox::DeviceCode wanted(const Configuration& configuration) {
  const std::string& code = configuration.lidar.device.code;
  return code == "any" ? livox::DeviceCode{} : livox::DeviceCode::of(code);
}

bool wants_imu(const Configuration& configuration) {
  return configuration.imu.enabled && configuration.imu.source == "livox";
}

std::optional<std::uint8_t> return_mode(DeviceReturns returns) {
  switch (returns) {
    case DeviceReturns::kFirst: return 0;
    case DeviceReturns::kStrongest: return 1;
    case DeviceReturns::kDual: return 2;
    case DeviceReturns::kTriple: return 3;
    case DeviceReturns::kUnchanged: break;
  }
  return std::nullopt;
}

livox::Sdk1HostConfig sdk1_config(const Configuration& configuration) {
  livox::Sdk1HostConfig config;
  config.device = wanted(configuration);
  config.command_port = static_cast<std::uint16_t>(configuration.lidar.command_port());
  config.data_port = static_cast<std::uint16_t>(configuration.lidar.listening_port());
  config.imu_port = config.data_port;
  config.coordinate = configuration.lidar.device.coordinates == DeviceCoordinates::kSpherical ? 1 : 0;
  config.return_mode = return_mode(configuration.lidar.device.returns);
  config.imu = wants_imu(configuration);
  return config;
}

livox::Sdk2HostConfig sdk2_config(const Configuration& configuration) {
  livox::Sdk2HostConfig config;
  config.serial_number = wanted(configuration);
  config.command_port = static_cast<std::uint16_t>(configuration.lidar.command_port());
  config.state_port = static_cast<std::uint16_t>(configuration.lidar.device.state_port);
  config.point_port = static_cast<std::uint16_t>(configuration.lidar.listening_port());
  config.imu_port = static_cast<std::uint16_t>(configuration.lidar.imu_port);
  config.point_type = configuration.lidar.device.coordinates == DeviceCoordinates::kSpherical ? 3 : 1;
  config.imu = wants_imu(configuration);
  config.take_over = configuration.lidar.device.take_over;
  return config;
}

}  // namespace

std::unique_ptr<livox::DeviceHost> make_host(const Configuration& configuration) {
  if (configuration.lidar.model == LidarModel::kLivoxAvia) {
    return std::make_unique<livox::Sdk1Host>(sdk1_config(configuration));
  }
  return std::make_unique<livox::Sdk2Host>(sdk2_config(configuration));
}

LivoxDevice::LivoxDevice(const Configuration& configuration)
    : host_(make_host(configuration)),
      words_(configuration.lidar.clock == configuration::SensorClock::kShared, configuration.lidar.device.set_utc),
      T_base_lidar_(configuration.lidar.T_base_lidar) {
  timed_ = configuration.lidar.device.set_utc ? dynamic_cast<livox::Sdk1Host*>(host_.get()) : nullptr;
  const bool avia = configuration.lidar.model == LidarModel::kLivoxAvia;
  const auto bind = [&](int port, DatagramSocket::Sharing sharing) {
    sockets_.push_back(std::make_unique<DatagramSocket>(static_cast<std::uint16_t>(port), sharing));
  };
  // Another daemon on this computer may look for another device.
  bind(avia ? livox::Sdk1Host::kBroadcastPort : livox::Sdk2Host::kDiscoveryPort, DatagramSocket::Sharing::kWithOthers);
  bind(configuration.lidar.command_port(), DatagramSocket::Sharing::kAlone);
  if (!avia) {
    bind(configuration.lidar.device.state_port, DatagramSocket::Sharing::kAlone);
  }
}

std::vector<int> LivoxDevice::fds() const {
  std::vector<int> fds;
  for (const auto& socket : sockets_) {
    fds.push_back(socket->fd());
  }
  return fds;
}

void LivoxDevice::run_once(Stamp now, Stamp data, const Say& say) {
  for (const auto& socket : sockets_) {
    for (int i = 0; i < kMostAtOnce; ++i) {
      const auto datagram = socket->receive();
      if (!datagram) {
        break;
      }
      if (!host_->is_connected()) {
        look_at_interfaces();
      }
      host_->receive(datagram->payload, {datagram->address, datagram->port}, now, out_);
      hand_out(say);
    }
  }
  host_->advance(now, out_);
  if (data_watch_.is_overdue(host_->is_sampling(), data, now)) {
    host_->set_again(now, out_);
  }
  hand_out(say);
}

void LivoxDevice::tell_time(const sensor::GnssFix& fix, Stamp now) {
  if (timed_ == nullptr || !host_->is_connected()) {
    return;
  }
  if (const std::optional<livox::Sdk1Utc> utc = utc_.due(fix, now)) {
    timed_->set_utc(*utc, out_);
    send_out();
  }
}

void LivoxDevice::stop(const Say& say) {
  host_->stop(out_);
  hand_out(say);
}

/// Addresses come and go with cables and DHCP.
void LivoxDevice::look_at_interfaces() {
  livox::HostInterfaces found;
  for (const transport::Interface& interface : transport::interfaces()) {
    found.try_push_back({interface.address, interface.netmask});
  }
  host_->set_interfaces(found);
}

void LivoxDevice::hand_out(const Say& say) {
  for (const livox::HostEvent& event : out_.events) {
    words_.take(event);
    if (event.kind == livox::HostEventKind::kTimeSet && std::exchange(time_was_set_, true)) {
      continue;  // once a second
    }
    time_was_set_ = time_was_set_ && event.kind != livox::HostEventKind::kConnected;
    std::string sentence = words_for(event);
    if (event.kind == livox::HostEventKind::kExtrinsicRead) {
      if (std::exchange(told_extrinsic_, sentence) == sentence) {
        continue;  // with each connection
      }
      const std::string remark = extrinsic_remark(event.extrinsic, T_base_lidar_);
      sentence += remark.empty() ? "" : "; " + remark;
    }
    say("device " + std::to_string(static_cast<int>(event.kind)) + event.command, sentence);
  }
  out_.events.clear();
  send_out();
}

void LivoxDevice::send_out() {
  for (const livox::HostOutput::Datagram& datagram : out_.datagrams) {
    for (const auto& socket : sockets_) {
      if (socket->port() == datagram.from_port) {
        socket->send(datagram.bytes.view(), datagram.to.address, datagram.to.port);
      }
    }
  }
  out_.datagrams.clear();
}

}  // namespace slamd::devices
