#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/latest.hpp"
#include "core/sensor/clock_model.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/stages/packet_stage.hpp"
#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/imu/csv_rows.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/serial_port.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::pipeline {

/// What the receive thread shows of one sensor.
struct SensorCounts {
  std::uint64_t received = 0;     // packets (LiDAR) or samples (imu) of use
  std::uint64_t dropped = 0;      // came, and could not be used
  std::uint64_t kernel_lost = 0;  // dropped in the kernel
  Stamp last{};                   // arrival of the newest; zero: never
  std::uint64_t clock_steps = 0;
  double clock_skew = 0.0;
  Duration clock_residual{};
  std::uint32_t source_address = 0;
};

struct ReceiveCounts {
  SensorCounts lidar;
  SensorCounts imu;
  std::uint64_t positions = 0;         // good position packets
  std::uint64_t blocks_dropped = 0;    // no free block
  std::uint64_t samples_dropped = 0;   // a ring to a late thread was full
};

/// The receive thread: datagrams and serial bytes to blocks and inertial samples on the time base.
/// Threads: run_once() by one; counts() by any.
/// Real-time: allocates in the constructor only; never blocks but in epoll.
class ReceiveLoop {
 public:
  /// A sensor that is silent for longer than this is said to be.
  static constexpr Duration kSilent = std::chrono::milliseconds(500);

  /// Binds the sockets. Errors: transport::TransportError, configuration::ConfigurationError.
  ReceiveLoop(const configuration::Configuration& configuration, const transport::HostClock& clock, Rings& rings);
  ~ReceiveLoop();
  ReceiveLoop(const ReceiveLoop&) = delete;
  ReceiveLoop& operator=(const ReceiveLoop&) = delete;

  /// Waits for input, at most `longest`, and handles all that is there.
  void run_once(Duration longest);

  /// From now on takes what the device at this address sends, wherever else something comes from; 0: no one is known.
  /// Any thread; it counts within 100 ms.
  void set_device(std::uint32_t address) { device_address_.store(address, std::memory_order_relaxed); }

  ReceiveCounts counts() const { return shown_.load().value_or(ReceiveCounts{}); }
  threads::EventRing& events() { return events_; }
  const threads::StageMonitor& monitor() const { return monitor_; }

  /// For after the thread has ended: all packets by what became of them, and what is odd about the device.
  stages::NamedCounts packets() const;
  std::vector<std::string> remarks() const { return packets_.remarks(); }

  /// Says in words what is wrong with the receive buffers; empty: nothing.
  std::string buffer_remark() const;

 private:
  enum Source : std::uint32_t { kLidar, kSecond, kImu };

  void open_imu(const configuration::Configuration& configuration, const transport::HostClock& clock);
  void watch(int fd, Source source);
  void receive_lidar(transport::UdpReceiver& receiver);
  void pin(std::uint32_t source_address);
  void take_packet(const transport::Datagram& datagram, transport::UdpReceiver& receiver);
  void receive_imu();
  void read_serial();
  void open_serial();
  void take_reading(const sensor::ImuReading& reading);
  void hand_on(const ImuArrival& arrival);
  void show(Stamp now);
  void note_silence(SensorCounts& counts, bool& heard, threads::Event event_heard, threads::Event event_silent, Stamp now);

  transport::HostClock clock_;
  Rings& rings_;
  stages::PacketStage packets_;
  std::unique_ptr<transport::UdpReceiver> lidar_;
  std::unique_ptr<transport::UdpReceiver> second_;  // where it has a port of its own
  std::unique_ptr<transport::UdpReceiver> imu_udp_;
  std::unique_ptr<transport::SerialPort> imu_serial_;
  imu::CsvRows imu_rows_;
  sensor::ClockModel imu_clock_;
  int epoll_ = -1;
  bool takes_livox_imu_ = false;
  bool lidar_heard_ = false;
  bool imu_heard_ = false;
  Stamp next_serial_try_{};
  Stamp last_shown_{};
  std::uint64_t other_packets_ = 0;
  std::uint64_t blocks_dropped_said_ = 0;
  sensor::PointBlock scrap_;  // decoded into when no block is free: every packet is accounted for
  ReceiveCounts counts_;
  std::atomic<std::uint32_t> device_address_{0};  // written by set_device(), read by the receive thread
  // Written by the receive thread, read by health.
  Latest<ReceiveCounts> shown_;
  threads::EventRing events_;
  threads::StageMonitor monitor_;
};

}  // namespace slamd::pipeline
