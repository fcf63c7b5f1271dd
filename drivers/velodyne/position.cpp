#include "drivers/velodyne/position.hpp"

#include "core/base/bytes.hpp"

namespace slamd::velodyne {

namespace {

constexpr std::size_t kPacketBytes = 512;
constexpr std::size_t kPositionTimestampAt = 0xC6;
constexpr std::size_t kPpsAt = 0xCA;
constexpr std::size_t kSentenceAt = 0xCE;
constexpr std::size_t kSentenceBytes = 128;

}  // namespace

PositionResult decode_position(std::span<const std::byte> payload, Position& position) {
  if (payload.size() != kPacketBytes) {
    return PositionResult::kWrongLength;
  }
  const auto timestamp_us = load_le<std::uint32_t>(payload, kPositionTimestampAt);
  if (timestamp_us >= 3'600'000'000U) {
    return PositionResult::kBadTimestamp;
  }
  position = Position{};
  position.device_stamp = DeviceStamp{} + std::chrono::microseconds(timestamp_us);
  const auto pps = load_le<std::uint8_t>(payload, kPpsAt);
  position.pps = pps <= 3 ? static_cast<PpsState>(pps) : PpsState::kUnknown;
  std::string_view sentence(reinterpret_cast<const char*>(payload.data()) + kSentenceAt, kSentenceBytes);
  sentence = sentence.substr(0, sentence.find_first_of(std::string_view("\r\n\0", 3)));
  for (const char c : sentence) {
    position.sentence.push_back(c);
  }
  return PositionResult::kOk;
}

}  // namespace slamd::velodyne
