#include "drivers/livox/control_frame.hpp"

namespace slamd::livox {

std::string_view name_of(FrameResult result) {
  switch (result) {
    case FrameResult::kOk:
      return "ok";
    case FrameResult::kTooShort:
      return "too_short";
    case FrameResult::kNotAFrame:
      return "not_a_frame";
    case FrameResult::kUnknownVersion:
      return "unknown_version";
    case FrameResult::kWrongLength:
      return "wrong_length";
    case FrameResult::kBadHeaderChecksum:
      return "bad_header_checksum";
    case FrameResult::kUnknownType:
      return "unknown_type";
    case FrameResult::kBadChecksum:
      return "bad_checksum";
  }
  return "?";
}

FrameBytes frame_bytes_of(std::span<const std::byte> bytes) {
  FrameBytes out;
  for (const std::byte byte : bytes) {
    out.push_back(byte);
  }
  return out;
}

}  // namespace slamd::livox
