#include "tools/sensors/avia_question.hpp"

#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::sensors {

using livox::Sdk1Command;
using livox::Sdk1FrameType;

livox::FrameBytes AviaQuestion::question(std::uint32_t host_address, std::uint16_t port) {
  if (answer_ >= AviaAnswer::kRefusal || number_ >= kTries) {
    return {};
  }
  answer_ = AviaAnswer::kNone;
  livox::Sdk1Handshake handshake;
  handshake.host_address = host_address;
  handshake.command_port = port;
  handshake.data_port = port;
  handshake.imu_port = port;
  return livox::write_sdk1_frame({Sdk1FrameType::kCommand, ++number_, Sdk1Command::kHandshake, handshake.bytes().view()});
}

livox::FrameBytes AviaQuestion::take(std::span<const std::byte> datagram) {
  livox::Sdk1Frame frame;
  std::size_t size = 0;
  if (parse_sdk1_frame(datagram, frame, size) != livox::FrameResult::kOk || frame.type != Sdk1FrameType::kAck ||
      frame.command != Sdk1Command::kHandshake || answer_ == AviaAnswer::kNotAsked) {
    return {};
  }
  const auto result = livox::result_of(frame.payload);
  if (!result) {
    return {};
  }
  if (*result != 0) {
    answer_ = answer_ == AviaAnswer::kConsent ? answer_ : AviaAnswer::kRefusal;
    return {};
  }
  answer_ = AviaAnswer::kConsent;
  return livox::write_sdk1_frame({Sdk1FrameType::kCommand, static_cast<std::uint16_t>(kTries + number_), Sdk1Command::kDisconnect, {}});
}

}  // namespace slamd::sensors
