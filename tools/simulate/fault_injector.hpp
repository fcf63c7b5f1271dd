#pragma once

#include <deque>
#include <filesystem>
#include <vector>

#include "drivers/recording/pcap_writer.hpp"
#include "tools/simulate/faults.hpp"
#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// Writes a capture with faults.
class FaultyCapture {
 public:
  FaultyCapture(const std::filesystem::path& file, const Faults& faults, std::uint64_t packets, FaultCounts& counts);

  /// Takes the next packet of the capture.
  void add(const recording::Packet& packet);

  void close();

 private:
  struct Held {
    recording::Packet packet;
    std::vector<std::byte> payload;
    Wire wire = Wire::kOther;
    int left = 0;  // intact point packets that still come before it
  };

  bool is_lost(double t_s, Wire wire, PacketFaults& counts) const;
  bool damage(Wire wire, PacketFaults& counts);
  void write(const recording::Packet& packet, Wire wire);
  void release(Stamp now);

  recording::PcapWriter writer_;
  const Faults& faults_;
  FaultCounts& counts_;
  Noise noise_;
  std::vector<std::uint64_t> burst_begins_;  // packet numbers
  std::uint64_t number_ = 0;
  std::optional<Stamp> first_;
  Stamp last_written_{};
  std::vector<std::byte> payload_;  // of the packet in hand
  std::deque<Held> held_;
};

}  // namespace slamd::simulate
