#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>

#include "drivers/recording/packet.hpp"

namespace slamd::recording {

/// Writes UDP datagrams to a classic pcap file with nanosecond stamps, as Ethernet and IPv4 frames with valid
/// checksums. Errors: RecordingError when the file cannot be written, or a payload is longer than any datagram's.
class PcapWriter {
 public:
  explicit PcapWriter(const std::filesystem::path& file);

  /// Appends a datagram. `destination_address` in host order.
  void write(const Packet& packet, std::uint32_t destination_address = 0xFFFFFFFF);

  /// Flushes and reports what the disk thinks of it.
  void close();

 private:
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
};

}  // namespace slamd::recording
