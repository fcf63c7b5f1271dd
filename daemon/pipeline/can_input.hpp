#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "daemon/configuration/configuration.hpp"
#include "daemon/stages/can_stage.hpp"
#include "daemon/threads/event_ring.hpp"
#include "drivers/transport/can_socket.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// The CAN buses that the receive thread listens to: one, or two where the wheels are on another one than the inertial
/// sensor.
/// Threads: receive(), tell() and what stage() returns belong to the receive thread (or, after its end, to anyone);
/// attend() to housekeeping; the others to any.
/// Real-time: allocates in the constructor only; receive() and tell() never block.
class CanInput {
 public:
  /// Errors: transport::TransportError.
  CanInput(const configuration::Configuration& configuration, const transport::HostClock& clock);

  std::size_t size() const { return buses_.size(); }
  const transport::CanSocket& socket(std::size_t bus) const { return *buses_[bus].socket; }

  /// Takes up to a batch of frames; calls on_reading(const sensor::ImuReading&) and on_wheels(const
  /// sensor::WheelSample&) for each that is complete.
  template <typename OnReading, typename OnWheels>
  void receive(std::size_t index, OnReading&& on_reading, OnWheels&& on_wheels) {
    Bus& bus = buses_[index];
    sensor::ImuReading reading;
    sensor::WheelSample sample;
    bus.socket->receive([&](const transport::CanFrame& frame) {
      if (bus.has_imu && stage_.take_imu(frame, reading)) {
        on_reading(reading);
      }
      if (bus.has_wheels && stage_.take_wheels(frame, sample)) {
        on_wheels(sample);
      }
    });
  }

  /// Writes an event for each thing that the controllers and the kernel have counted since the last call.
  void tell(Stamp now, threads::EventRing& events);

  /// Looks for the interfaces; calls say(interface, what it is found to be, in words) where that is news.
  template <typename Say>
  void attend(Say&& say) {
    for (Bus& bus : buses_) {
      if (const transport::CanLink link = bus.socket->attend(); link != bus.said_link) {
        bus.said_link = link;
        say(bus.socket->interface(), transport::in_words(link));
      }
    }
  }

  const stages::CanStage& stage() const { return stage_; }

  /// Frames that the kernel has lost of the bus with the inertial sensor, and of the one with the wheels alone.
  std::uint64_t imu_lost() const;
  std::uint64_t wheels_lost() const;

  /// Of all buses.
  transport::CanCounters counters() const;
  stages::NamedCounts named_counts() const;

  /// Says in words what is wrong with the receive buffers; empty: nothing.
  std::string buffer_remark() const;

 private:
  struct Bus {
    std::unique_ptr<transport::CanSocket> socket;
    bool has_imu = false;
    bool has_wheels = false;
    transport::CanCounters said;                                   // receive thread's
    transport::CanLink said_link = transport::CanLink::kUnknown;  // housekeeping's
  };

  stages::CanStage stage_;
  std::vector<Bus> buses_;
};

}  // namespace slamd::pipeline
