#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "core/sensor/imu_sample.hpp"
#include "drivers/recording/packet.hpp"
#include "tools/simulate/faults.hpp"
#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// Damages a stream of packets, and one of inertial rows, on its way from a sensor or a file to wherever it goes.
/// Moments count from the first packet, and of rows from the first row.
class FaultInjector {
 public:
  /// Takes a packet, whose bytes are valid during the call.
  using Sink = std::function<void(const recording::Packet&)>;

  /// `length_s` is what bursts are spread over.
  FaultInjector(const Faults& faults, double length_s);

  /// Takes the next packet; hands on what comes of it.
  void add(const recording::Packet& packet, const Sink& sink);

  /// Hands on what was still held back.
  void finish(const Sink& sink);

  /// Shifts a row's stamp; returns false when the row is lost. What is cut to limits is for the caller to count.
  bool pass_row(Stamp& stamp);

  /// Takes the next row; returns false when it is lost.
  bool pass(sensor::ImuSample& row);

  FaultCounts& counts() { return counts_; }

 private:
  struct Held {
    recording::Packet packet;
    std::vector<std::byte> payload;
    Wire wire = Wire::kOther;
    int left = 0;  // intact point packets that still come before it
  };

  bool is_lost(double t_s, Wire wire, PacketFaults& counts);
  bool is_in_burst(double t_s);
  bool damage(Wire wire, PacketFaults& counts);
  void hand_on(const recording::Packet& packet, Wire wire, const Sink& sink);
  void release(Stamp now, const Sink& sink);

  Faults faults_;
  FaultCounts counts_;
  Noise noise_;
  std::vector<double> bursts_s_;  // when they begin, the last first
  std::uint64_t burst_end_ = 0;   // the first packet number after the burst
  std::uint64_t number_ = 0;
  std::optional<Stamp> first_;
  std::optional<Stamp> first_row_;
  Stamp last_{};
  std::vector<std::byte> payload_;  // of the packet in hand
  std::deque<Held> held_;
};

}  // namespace slamd::simulate
