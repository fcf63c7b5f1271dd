#include "daemon/pipeline/receive_loop.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <sys/epoll.h>
#include <unistd.h>

namespace slamd::pipeline {

using configuration::Configuration;
using configuration::ConfigurationError;
using configuration::LidarModel;
using threads::Event;
using transport::Datagram;
using transport::UdpReceiver;

namespace {

constexpr Duration kShowPeriod = std::chrono::milliseconds(100);
/// Silent for so long, the sensor may come back with another address.
constexpr Duration kForgetSource = std::chrono::seconds(3);

std::uint16_t data_port(const Configuration& configuration) {
  return static_cast<std::uint16_t>(configuration.lidar.listening_port());
}

/// The port of what a LiDAR sends beside its points: position packets, or a Mid-360's own samples; 0: none.
std::uint16_t second_port(const Configuration& configuration) {
  int port = 0;
  if (!is_livox(configuration.lidar.model)) {
    port = configuration.lidar.position_port;
  } else if (configuration.lidar.model == LidarModel::kLivoxMid360) {
    port = configuration.lidar.imu_port;
  }
  return port == data_port(configuration) ? std::uint16_t{0} : static_cast<std::uint16_t>(port);
}

std::unique_ptr<UdpReceiver> receiver(const Configuration& configuration, std::uint16_t port, const transport::HostClock& clock) {
  transport::UdpReceiverConfig config;
  config.bind_address = configuration.lidar.bind_address;
  config.source_address = configuration.lidar.source_address;
  config.port = port;
  return std::make_unique<UdpReceiver>(config, clock);
}

}  // namespace

ReceiveLoop::ReceiveLoop(const Configuration& configuration, const transport::HostClock& clock, Rings& rings)
    : clock_(clock), rings_(rings), packets_(configuration), imu_stream_(configuration.imu.protocol), imu_clock_(stages::imu_clock(configuration.imu)) {
  if (configuration.lidar.model == LidarModel::kPoints) {
    throw ConfigurationError("lidar.model = \"points\": a folder of clouds is for slamd-replay; slamd listens to sensors");
  }
  epoll_ = epoll_create1(EPOLL_CLOEXEC);
  if (epoll_ < 0) {
    throw std::system_error(errno, std::generic_category(), "epoll");
  }
  lidar_ = receiver(configuration, data_port(configuration), clock);
  watch(lidar_->fd(), kLidar);
  if (const std::uint16_t port = second_port(configuration); port != 0) {
    second_ = receiver(configuration, port, clock);
    watch(second_->fd(), kSecond);
  }
  if (configuration.imu.enabled) {
    open_imu(configuration, clock);
  }
  open_can(configuration, clock);
}

ReceiveLoop::~ReceiveLoop() { close(epoll_); }

void ReceiveLoop::open_can(const Configuration& configuration, const transport::HostClock& clock) {
  const configuration::WheelConfiguration& wheel = configuration.wheel;
  const bool has_wheels = wheel.use && !wheel.source.empty();
  if (has_wheels && wheel.source != "can") {
    throw ConfigurationError("wheel.source = \"" + wheel.source + "\": a file is for slamd-replay; slamd takes can (or none: wheel.use = false)");
  }
  if (!has_wheels && !(configuration.imu.enabled && configuration.imu.source == "can")) {
    return;
  }
  can_ = std::make_unique<CanInput>(configuration, clock);
  for (std::size_t bus = 0; bus < can_->size(); ++bus) {
    watch(can_->socket(bus).fd(), bus == 0 ? kCan : kSecondCan);
  }
}

void ReceiveLoop::open_imu(const Configuration& configuration, const transport::HostClock& clock) {
  const std::string& source = configuration.imu.source;
  if (source == "livox") {
    takes_livox_imu_ = true;
  } else if (source == "udp") {
    transport::UdpReceiverConfig config;
    config.bind_address = configuration.lidar.bind_address;
    config.port = static_cast<std::uint16_t>(configuration.imu.port);
    imu_udp_ = std::make_unique<UdpReceiver>(config, clock);
    watch(imu_udp_->fd(), kImu);
  } else if (source == "serial") {
    serial_ = std::make_unique<SerialLine>(configuration.imu.device);
    mends_silence_ = configuration.imu.baud == 0 || configuration.imu.rate_hz != 0;
    watch(serial_->handed_fd(), kSerial);
  } else if (source != "can") {
    throw ConfigurationError("imu.source = \"" + source + "\": a file is for slamd-replay; slamd takes livox, udp, serial or can");
  }
}

void ReceiveLoop::watch(int fd, Source source) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u32 = source;
  if (epoll_ctl(epoll_, EPOLL_CTL_ADD, fd, &event) != 0) {
    throw std::system_error(errno, std::generic_category(), "epoll");
  }
}

void ReceiveLoop::run_once(Duration longest) {
  std::array<epoll_event, 6> events{};
  const auto timeout_ms = static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(longest).count());
  const int ready = epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), timeout_ms);
  for (int i = 0; i < ready; ++i) {
    switch (events[static_cast<std::size_t>(i)].data.u32) {
      case kLidar: receive_lidar(*lidar_); break;
      case kSecond: receive_lidar(*second_); break;
      case kSerial: take_serial(); break;
      case kCan: receive_can(0); break;
      case kSecondCan: receive_can(1); break;
      default: receive_imu(); break;
    }
  }
  const Stamp now = clock_.now();
  if (has_serial_ && mends_silence_ && now - std::max(counts_.imu.last, serial_since_) > kSerialSilent) {
    return_serial();
  }
  if (now - last_shown_ >= kShowPeriod) {
    show(now);
  }
}

void ReceiveLoop::receive_lidar(UdpReceiver& receiver) {
  receiver.receive([&](const Datagram& datagram) { take_packet(datagram, receiver); });
}

void ReceiveLoop::take_packet(const Datagram& datagram, UdpReceiver& receiver) {
  BlockPool::Handle block = rings_.block_pool.acquire();
  recording::Packet packet;
  packet.received = datagram.received;
  packet.destination_port = datagram.destination_port;
  packet.payload = datagram.payload;
  const stages::PacketOutcome outcome = packets_.add(packet, block ? *block : scrap_);
  if (!outcome.has_block) {
    if (block) {
      rings_.block_pool.put_back(std::move(block));
    }
    if (outcome.imu) {
      ++counts_.imu.received;
      counts_.imu.last = datagram.received;
      hand_on({*outcome.imu, datagram.received});
    } else {
      (outcome.is_position ? counts_.positions : other_packets_) += 1;
      return;
    }
  } else {
    ++counts_.lidar.received;
    counts_.lidar.last = datagram.received;
    counts_.lidar.source_address = datagram.source_address;
    if (!receiver.pinned()) {
      pin(datagram.source_address);
    }
    if (!block) {
      ++counts_.blocks_dropped;
    } else {
      rings_.blocks.try_push(std::move(block));  // as long as its pool: there is room
      rings_.wake_preprocess.notify();
    }
  }
  const Stamp now = clock_.now();
  monitor_.add(now - datagram.received, now);
}

void ReceiveLoop::pin(std::uint32_t source_address) {
  lidar_->pin(source_address);
  if (second_) {
    second_->pin(source_address);
  }
}

void ReceiveLoop::receive_imu() {
  if (serial_) {
    read_serial();
    return;
  }
  imu_udp_->receive([&](const Datagram& datagram) {
    imu_rows_.add_datagram(datagram.payload, datagram.received, [&](const sensor::ImuReading& reading) {
      imu_udp_->pin(datagram.source_address);
      take_reading(reading);
    });
  });
}

void ReceiveLoop::receive_can(std::size_t bus) {
  can_->receive(bus, [&](const sensor::ImuReading& reading) { take_reading(reading); },
                [&](const sensor::WheelSample& sample) { take_wheels(sample); });
}

void ReceiveLoop::take_wheels(const sensor::WheelSample& sample) {
  ++counts_.wheels.received;
  counts_.wheels.last = sample.stamp;
  counts_.samples_dropped += rings_.wheels_to_preprocess.try_push(sample) ? 0 : 1;
  rings_.wake_preprocess.notify();
}

void ReceiveLoop::take_serial() {
  if (!serial_->take() || has_serial_) {
    return;
  }
  has_serial_ = true;
  serial_since_ = clock_.now();
  read_serial(serial_->rest());
  watch(serial_->port().fd(), kImu);
}

void ReceiveLoop::read_serial() {
  if (!has_serial_) {
    return;  // was given back in this very round
  }
  read_serial(serial_->port().read());
  if (serial_->port().is_gone()) {
    return_serial();
  }
}

void ReceiveLoop::read_serial(std::span<const std::byte> bytes) {
  imu_stream_.add(bytes, clock_.now(), [&](const sensor::ImuReading& reading) { take_reading(reading); });
}

void ReceiveLoop::return_serial() {
  epoll_ctl(epoll_, EPOLL_CTL_DEL, serial_->port().fd(), nullptr);
  imu_stream_.finish(clock_.now(), [&](const sensor::ImuReading& reading) { take_reading(reading); });
  has_serial_ = false;
  serial_->give_back();
}

void ReceiveLoop::take_reading(const sensor::ImuReading& reading) {
  ++counts_.imu.received;
  counts_.imu.last = reading.received;
  imu_units_.add(reading);
  hand_on({{imu_clock_.map(reading.device_stamp, reading.received), reading.angular_rate_radps, reading.specific_force_mps2},
           reading.received});
}

void ReceiveLoop::hand_on(const ImuArrival& arrival) {
  const bool to_publish = rings_.imu_to_publish.try_push(arrival);
  const bool to_preprocess = rings_.imu_to_preprocess.try_push(arrival);
  counts_.samples_dropped += (to_publish ? 0 : 1) + (to_preprocess ? 0 : 1);
  rings_.wake_publish.notify();
  rings_.wake_preprocess.notify();
}

void ReceiveLoop::note_silence(SensorCounts& counts, bool& heard, Event event_heard, Event event_silent, Stamp now) {
  const bool hears = counts.last != Stamp{} && now - counts.last < kSilent;
  if (hears != heard) {
    heard = hears;
    events_.write(now, hears ? event_heard : event_silent, counts.source_address);
  }
}

void ReceiveLoop::show(Stamp now) {
  last_shown_ = now;
  if (counts_.blocks_dropped != blocks_dropped_said_) {
    blocks_dropped_said_ = counts_.blocks_dropped;
    events_.write(now, Event::kBlockPoolEmpty, counts_.blocks_dropped);
  }
  note_silence(counts_.lidar, lidar_heard_, Event::kLidarHeard, Event::kLidarSilent, now);
  note_silence(counts_.imu, imu_heard_, Event::kImuHeard, Event::kImuSilent, now);
  note_silence(counts_.wheels, wheels_heard_, Event::kWheelsHeard, Event::kWheelsSilent, now);
  if (const std::uint32_t device = device_address_.load(std::memory_order_relaxed); device != 0) {
    pin(device);
  } else if (counts_.lidar.last != Stamp{} && now - counts_.lidar.last > kForgetSource) {
    lidar_->unpin();
    if (second_) {
      second_->unpin();
    }
  }
  if (imu_udp_ && counts_.imu.last != Stamp{} && now - counts_.imu.last > kForgetSource) {
    imu_udp_->unpin();
  }
  const transport::UdpCounters udp = lidar_->counters();
  counts_.lidar.kernel_lost = udp.kernel_lost;
  counts_.lidar.dropped = udp.foreign_source + udp.truncated + other_packets_ + counts_.blocks_dropped;
  const sensor::ClockHealth& clock = packets_.clock();
  counts_.lidar.clock_steps = clock.steps;
  counts_.lidar.clock_skew = clock.skew;
  counts_.lidar.clock_residual = clock.residual_mean;
  show_imu();
  counts_.gnss = packets_.gnss_stage().state();
  if (can_) {
    show_wheels();
    can_->tell(now, events_);
  }
  shown_.store(counts_);
}

void ReceiveLoop::show_imu() {
  const sensor::ClockHealth& clock = takes_livox_imu_ ? packets_.clock() : imu_clock_.health();
  counts_.imu.clock_steps = clock.steps;
  counts_.imu.clock_skew = clock.skew;
  counts_.imu.clock_residual = clock.residual_mean;
  counts_.imu.dropped = 0;
  if (imu_udp_) {
    const transport::UdpCounters imu_udp = imu_udp_->counters();
    counts_.imu.kernel_lost = imu_udp.kernel_lost;
    counts_.imu.dropped = imu_udp.foreign_source + imu_udp.truncated;
  }
  const imu::RowCounters rows = imu_rows_.counters();
  for (std::size_t i = 1; i < imu::kRowResults; ++i) {
    counts_.imu.dropped += rows.rows[i];
  }
  if (can_) {
    counts_.imu.kernel_lost = can_->imu_lost();
  }
  const imu::StreamSummary stream = can_ && can_->stage().takes_imu() ? can_->stage().imu_summary() : imu_stream_.summary();
  counts_.imu.dropped += stream.refused;
  counts_.imu.missing = stream.missing;
  counts_.samples_clipped = stream.clipped;
  counts_.imu_units = imu_units_.units();
}

void ReceiveLoop::show_wheels() {
  counts_.wheels.dropped = can_->stage().wheels_refused();
  counts_.wheels.kernel_lost = can_->wheels_lost();
}

stages::NamedCounts ReceiveLoop::packets() const {
  stages::NamedCounts counts = packets_.packets();
  const auto add = [&](const char* name, std::uint64_t count) {
    if (count != 0) {
      counts.emplace_back(name, count);
    }
  };
  transport::UdpCounters sum = lidar_->counters();
  if (second_) {
    const transport::UdpCounters more = second_->counters();
    sum.foreign_source += more.foreign_source;
    sum.truncated += more.truncated;
    sum.kernel_lost += more.kernel_lost;
  }
  add("refused_foreign_source", sum.foreign_source);
  add("refused_truncated", sum.truncated);
  add("lost_in_the_kernel", sum.kernel_lost);
  return counts;
}

stages::NamedCounts ReceiveLoop::inertial() const {
  stages::NamedCounts counts;
  const auto add = [&](const char* name, std::uint64_t count) {
    if (count != 0) {
      counts.emplace_back(name, count);
    }
  };
  if (imu_udp_) {
    const imu::RowCounters rows = imu_rows_.counters();
    for (std::size_t i = 0; i < imu::kRowResults; ++i) {
      add(i == 0 ? "sample" : imu::name_of(static_cast<imu::RowResult>(i)), rows.rows[i]);
    }
  } else if (serial_) {
    imu_stream_.each_count(add);
  } else if (can_ && can_->stage().takes_imu()) {
    return can_->stage().inertial();
  }
  return counts;
}

std::string ReceiveLoop::buffer_remark() const {
  const std::string remark = lidar_->buffer_remark();
  return remark.empty() && can_ ? can_->buffer_remark() : remark;
}

}  // namespace slamd::pipeline
