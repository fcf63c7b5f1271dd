#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/livox/control_frame.hpp"

namespace slamd::livox {

/// What a control frame is to its receiver. Source: livox-sdk1.md §2.
enum class Sdk1FrameType : std::uint8_t {
  kCommand = 0,  // wants an answer
  kAck = 1,      // repeats the command's number
  kMessage = 2,  // wants none
};

/// Command set and command, as one number: set · 256 + id. Source: livox-sdk1.md §4.
enum class Sdk1Command : std::uint16_t {
  kBroadcast = 0x0000,
  kHandshake = 0x0001,
  kDeviceInfo = 0x0002,
  kHeartbeat = 0x0003,
  kSampling = 0x0004,
  kCoordinate = 0x0005,
  kDisconnect = 0x0006,
  kAbnormalStatus = 0x0007,
  kSetAddress = 0x0008,
  kGetAddress = 0x0009,
  kReboot = 0x000A,
  kWriteParameters = 0x000B,
  kReadParameters = 0x000C,
  kResetParameters = 0x000D,
  kSetMode = 0x0100,
  kSetExtrinsic = 0x0101,
  kGetExtrinsic = 0x0102,
  kSetReturnMode = 0x0106,
  kGetReturnMode = 0x0107,
  kSetImuRate = 0x0108,
  kGetImuRate = 0x0109,
  kSetUtc = 0x010A,
};

/// A control frame; payload points into the bytes that it was read from.
struct Sdk1Frame {
  Sdk1FrameType type = Sdk1FrameType::kCommand;
  std::uint16_t sequence = 0;
  Sdk1Command command = Sdk1Command::kBroadcast;  // any 16 bits may come in
  std::span<const std::byte> payload;
};

/// Reads the frame at the front of a datagram, which may hold several: size tells where the next one
/// begins. Errors: a refusal leaves frame and size untouched; the rest of the datagram is then of no
/// use, because nothing tells where another frame would begin.
FrameResult parse_sdk1_frame(std::span<const std::byte> bytes, Sdk1Frame& frame, std::size_t& size);

/// Writes a frame with its checksums. The caller's payload fits into FrameBytes.
FrameBytes write_sdk1_frame(const Sdk1Frame& frame);

}  // namespace slamd::livox
