#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

#include "core/base/stamp.hpp"

namespace slamd::recording {

/// A recording that cannot be read. One line, with the file and the cause.
class RecordingError : public std::runtime_error {
 public:
  RecordingError(const std::filesystem::path& file, const std::string& cause)
      : std::runtime_error(file.string() + ": " + cause) {}
};

/// One UDP datagram of a capture.
struct Packet {
  Stamp received{};
  std::uint32_t source_address = 0;  // host order: 192.168.1.201 is 0xC0A801C9
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::span<const std::byte> payload;  // valid until the next packet is read
};

}  // namespace slamd::recording
