#include "drivers/livox/decode_result.hpp"

namespace slamd::livox {

std::string_view name_of(DecodeResult result) {
  switch (result) {
    case DecodeResult::kPoints:
      return "points";
    case DecodeResult::kImu:
      return "imu";
    case DecodeResult::kControlFrame:
      return "control_frame";
    case DecodeResult::kTooShort:
      return "too_short";
    case DecodeResult::kUnknownVersion:
      return "unknown_version";
    case DecodeResult::kUnknownDataType:
      return "unknown_data_type";
    case DecodeResult::kWrongLength:
      return "wrong_length";
    case DecodeResult::kBadTimestampType:
      return "bad_timestamp_type";
    case DecodeResult::kBadTimestamp:
      return "bad_timestamp";
    case DecodeResult::kBadImu:
      return "bad_imu";
    case DecodeResult::kBadChecksum:
      return "bad_checksum";
  }
  return "?";
}

}  // namespace slamd::livox
