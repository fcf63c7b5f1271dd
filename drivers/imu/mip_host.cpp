#include "drivers/imu/mip_host.hpp"

#include <algorithm>
#include <array>

#include "core/base/bytes.hpp"

namespace slamd::imu {

namespace {

/// What is asked for, the richest first; older models know neither reference times nor overrange flags.
constexpr std::array<std::array<std::uint8_t, 5>, 4> kFormats{{
    {mip::kReferenceTime, mip::kDeltaReferenceTime, mip::kAcceleration, mip::kTurnRate, mip::kOverrange},
    {mip::kReferenceTime, mip::kDeltaReferenceTime, mip::kAcceleration, mip::kTurnRate},
    {mip::kReferenceTime, mip::kAcceleration, mip::kTurnRate},
    {mip::kGpsTimestamp, mip::kAcceleration, mip::kTurnRate},
}};

}  // namespace

void MipHost::begin(int rate_hz, Stamp now, LineOutput& out) {
  Dialogue::begin();
  wanted_hz_ = rate_hz;
  format_ = 0;
  go(Step::kIdle, now, out);
}

void MipHost::take(const MipPacket& packet, Stamp now, LineOutput& out) {
  const std::optional<MipAck> ack = ack_of(packet);
  const bool base = step_ == Step::kIdle || step_ == Step::kResume;
  if (!is_under_way() || !ack || ack->command != command() ||
      packet.set != (base ? mip::kBaseCommands : mip::kSensorCommands)) {
    return;
  }
  if (step_ == Step::kBaseRate && (ack->code != 0 || !read_base_rate(packet))) {
    refuse(ack->code, now, out);
  } else if (step_ == Step::kFormat && ack->code != 0) {
    if (++format_ < kFormats.size()) {
      go(Step::kFormat, now, out);
    } else {
      refuse(ack->code, now, out);
    }
  } else {
    go_on(now, out);  // a model that has no idle state or no stream to enable says no to those
  }
}

void MipHost::advance(Stamp now, LineOutput& out) {
  if (is_to_be_repeated(now)) {
    send_step(now, out);
  }
}

void MipHost::go(Step step, Stamp now, LineOutput& out) {
  step_ = step;
  begin_command();
  send_step(now, out);
}

void MipHost::go_on(Stamp now, LineOutput& out) {
  if (step_ == Step::kResume) {
    end();
  } else {
    go(static_cast<Step>(static_cast<int>(step_) + 1), now, out);
  }
}

void MipHost::refuse(std::uint8_t code, Stamp now, LineOutput& out) {
  note_refusal(code);
  go(Step::kResume, now, out);
}

void MipHost::send_step(Stamp now, LineOutput& out) {
  note_sent(now);
  if (step_ == Step::kFormat) {
    FixedVector<MipOutput, 5> outputs;
    for (const std::uint8_t descriptor : kFormats[format_]) {
      if (descriptor != 0) {
        outputs.push_back({descriptor, decimation_});
      }
    }
    out.send(write_message_format(outputs.view()).view());
    return;
  }
  // A field: its length, the command, what belongs to it.
  FixedVector<std::byte, 5> field{std::byte{2}, std::byte{command()}};
  if (step_ == Step::kBaseRate) {
    field.push_back(std::byte{mip::kSensorData});
  } else if (step_ == Step::kStream) {
    for (const std::uint8_t value : {mip::kSet, mip::kSensorData, std::uint8_t{1}}) {
      field.push_back(std::byte{value});
    }
  }
  field[0] = static_cast<std::byte>(field.size());
  const bool base = step_ == Step::kIdle || step_ == Step::kResume;
  out.send(write_mip({base ? mip::kBaseCommands : mip::kSensorCommands, field.view()}).view());
}

/// The set, and its samples a second before decimation.
bool MipHost::read_base_rate(const MipPacket& packet) {
  MipFields fields(packet.payload);
  MipField field;
  while (fields.next(field)) {
    if (field.descriptor == mip::kBaseRateReply && field.data.size() == 3 && load_be<std::uint16_t>(field.data, 1) > 0) {
      const int base_hz = load_be<std::uint16_t>(field.data, 1);
      const int decimation = std::max(1, (base_hz + wanted_hz_ / 2) / std::max(1, wanted_hz_));
      decimation_ = static_cast<std::uint16_t>(decimation);
      promise(base_hz / decimation);
      return true;
    }
  }
  return false;
}

std::uint8_t MipHost::command() const {
  switch (step_) {
    case Step::kIdle: return mip::kIdle;
    case Step::kBaseRate: return mip::kBaseRate;
    case Step::kFormat: return mip::kMessageFormat;
    case Step::kStream: return mip::kDataStream;
    default: return mip::kResume;
  }
}

}  // namespace slamd::imu
