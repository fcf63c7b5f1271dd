#pragma once

#include <array>
#include <filesystem>
#include <memory>

#include "drivers/recording/frame.hpp"
#include "drivers/recording/packet.hpp"

struct pcap;

namespace slamd::recording {

/// What was in a capture.
struct PcapCounters {
  std::array<std::uint64_t, kFrameKinds> frames{};
  bool ended_in_a_record = false;  // the file stops in the middle of a record; what came before stays

  std::uint64_t of(FrameKind kind) const { return frames[static_cast<std::size_t>(kind)]; }
};

/// Reads the UDP datagrams of a capture file in its order: classic pcap (µs and ns) and pcapng, by libpcap.
/// Errors: RecordingError when the file cannot be opened or is no capture; frames that are no whole UDP datagram are
/// counted by kind and passed over.
class PcapReader {
 public:
  explicit PcapReader(const std::filesystem::path& file);
  ~PcapReader();
  PcapReader(const PcapReader&) = delete;
  PcapReader& operator=(const PcapReader&) = delete;

  /// Reads the next datagram; false at the end.
  bool next(Packet& packet);

  const PcapCounters& counters() const { return counters_; }

 private:
  std::unique_ptr<pcap, void (*)(pcap*)> handle_;
  int link_;
  PcapCounters counters_;
};

}  // namespace slamd::recording
