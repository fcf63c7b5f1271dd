#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/latest.hpp"
#include "core/sensor/clock_model.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/pipeline/can_input.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/pipeline/serial_line.hpp"
#include "daemon/stages/packet_stage.hpp"
#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/imu/imu_stream.hpp"
#include "drivers/imu/unit_watch.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::pipeline {

/// What the receive thread shows of one sensor.
struct SensorCounts {
  std::uint64_t received = 0;     // packets (LiDAR) or samples (imu) of use
  std::uint64_t dropped = 0;      // came, and could not be used
  std::uint64_t kernel_lost = 0;  // dropped in the kernel
  std::uint64_t missing = 0;      // sent and never come, by the sensor's own count
  Stamp last{};                   // arrival of the newest; zero: never
  std::uint64_t clock_steps = 0;
  double clock_skew = 0.0;
  Duration clock_residual{};
  std::uint32_t source_address = 0;
};

struct ReceiveCounts {
  SensorCounts lidar;
  SensorCounts imu;
  SensorCounts wheels;
  std::uint64_t positions = 0;         // good position packets
  std::uint64_t blocks_dropped = 0;    // no free block
  std::uint64_t samples_dropped = 0;   // a ring to a late thread was full
  std::uint64_t samples_clipped = 0;   // at the sensor's limits, as it says itself
  stages::GnssState gnss;              // out of position packets
  imu::Units imu_units = imu::Units::kUnknown;
};

/// The receive thread: datagrams, serial bytes and CAN frames to blocks and samples on the time base.
/// Threads: run_once() by one; counts() by any.
/// Real-time: allocates in the constructor only; never blocks but in epoll. A serial port is opened and closed
/// by a SerialLoop, and CAN interfaces are looked after by housekeeping, for that may block; see serial_line(), can().
class ReceiveLoop {
 public:
  /// A sensor that is silent for longer than this is said to be.
  static constexpr Duration kSilent = std::chrono::milliseconds(500);
  /// A serial port that is silent for longer than this is handed back, where that may help.
  static constexpr Duration kSerialSilent = std::chrono::seconds(2);

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

  /// The inertial sensor's port, which a SerialLoop must serve; nullptr without one.
  SerialLine* serial_line() { return serial_.get(); }

  /// The CAN buses, which housekeeping must attend; nullptr without one.
  CanInput* can() { return can_.get(); }
  const CanInput* can() const { return can_.get(); }

  ReceiveCounts counts() const { return shown_.load().value_or(ReceiveCounts{}); }
  threads::EventRing& events() { return events_; }
  const threads::StageMonitor& monitor() const { return monitor_; }

  /// For after the thread has ended: all packets by what became of them, and what is odd about the device.
  stages::NamedCounts packets() const;
  std::vector<std::string> remarks() const { return packets_.remarks(); }

  /// Likewise: what a port or a bus of its own has brought of the inertial sensor, by what became of it; empty without one.
  stages::NamedCounts inertial() const;

  /// Likewise: what position packets have brought of a satellite receiver; empty where that is not configured.
  stages::NamedCounts gnss() const { return packets_.gnss_counts(); }

  /// Likewise, of the wheels, and of all CAN frames; empty without them.
  stages::NamedCounts wheels() const { return can_ ? can_->stage().wheels() : stages::NamedCounts{}; }
  stages::NamedCounts can_frames() const { return can_ ? can_->named_counts() : stages::NamedCounts{}; }

  /// Says in words what is wrong with the receive buffers; empty: nothing.
  std::string buffer_remark() const;

 private:
  enum Source : std::uint32_t { kLidar, kSecond, kImu, kSerial, kCan, kSecondCan };

  void open_can(const configuration::Configuration& configuration, const transport::HostClock& clock);
  void open_imu(const configuration::Configuration& configuration, const transport::HostClock& clock);
  void watch(int fd, Source source);
  void receive_lidar(transport::UdpReceiver& receiver);
  void pin(std::uint32_t source_address);
  void take_packet(const transport::Datagram& datagram, transport::UdpReceiver& receiver);
  void receive_imu();
  void receive_can(std::size_t bus);
  void take_wheels(const sensor::WheelSample& sample);
  void take_serial();
  void read_serial();
  void read_serial(std::span<const std::byte> bytes);
  void return_serial();
  void take_reading(const sensor::ImuReading& reading);
  void hand_on(const ImuArrival& arrival);
  void show(Stamp now);
  void show_imu();
  void show_wheels();
  void note_silence(SensorCounts& counts, bool& heard, threads::Event event_heard, threads::Event event_silent, Stamp now);

  transport::HostClock clock_;
  Rings& rings_;
  stages::PacketStage packets_;
  std::unique_ptr<transport::UdpReceiver> lidar_;
  std::unique_ptr<transport::UdpReceiver> second_;  // where it has a port of its own
  std::unique_ptr<transport::UdpReceiver> imu_udp_;
  std::unique_ptr<SerialLine> serial_;
  std::unique_ptr<CanInput> can_;
  imu::CsvRows imu_rows_;      // of "udp"
  imu::ImuStream imu_stream_;  // of "serial"
  imu::UnitWatch imu_units_;
  sensor::ClockModel imu_clock_;
  int epoll_ = -1;
  bool takes_livox_imu_ = false;
  bool lidar_heard_ = false;
  bool imu_heard_ = false;
  bool wheels_heard_ = false;
  bool has_serial_ = false;  // this thread has the port
  bool mends_silence_ = false;
  Stamp serial_since_{};
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
