#include "tools/replay/emulated_imu.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/bytes.hpp"

namespace slamd::replay {

using sensor::ImuSample;

namespace {

template <typename Bytes>
void append(const Bytes& bytes, std::string& out) {
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// Rows, which no host can configure.
class EmulatedRows : public EmulatedImu {
 public:
  void hear(std::span<const std::byte>, std::string&) override {}

  bool sample(const ImuSample& sample, std::string& out) override {
    out += row_of(sample);
    return true;
  }

  std::string greeting() const override { return "\n"; }  // a reader trusts no row whose beginning it may have missed
};

/// An Xsens MTi: imu-serial.md §A.2.
class EmulatedXsens : public EmulatedImu {
 public:
  explicit EmulatedXsens(int rate_hz) : rate_hz_(static_cast<std::uint16_t>(rate_hz)) {
    outputs_ = {{imu::mt::kPacketCounter, imu::mt::kFastest}, {imu::mt::kSampleTimeFine, imu::mt::kFastest},
                {imu::mt::kAcceleration, rate_hz_}, {imu::mt::kRateOfTurn, rate_hz_}};
  }

  void hear(std::span<const std::byte> bytes, std::string& out) override {
    frames_.add(bytes, [&](std::span<const std::byte> frame) { obey(imu::Xbus::parse(frame), out); });
  }

  bool sample(const ImuSample& sample, std::string& out) override {
    first_ = first_.value_or(sample.stamp);
    if (!measures_ || index_++ % part_ != 0) {
      return false;
    }
    // 0.1 ms ticks, as the device has them; it has been on for a while.
    constexpr std::int64_t kTick_ns = 100'000;
    const auto ticks = static_cast<std::uint32_t>(1'000'000 + ((sample.stamp - *first_).count() + kTick_ns / 2) / kTick_ns);
    append(imu::write_sample(outputs_, {count_++, ticks, sample.specific_force_mps2, sample.angular_rate_radps}), out);
    return true;
  }

 private:
  void obey(const imu::XbusMessage& message, std::string& out) {
    namespace xbus = imu::xbus;
    const auto answer = [&](std::span<const std::byte> data) {
      append(imu::write_xbus({static_cast<std::uint8_t>(message.id + 1), data}), out);
    };
    if (message.id == xbus::kGoToConfig || message.id == xbus::kGoToMeasurement) {
      measures_ = message.id == xbus::kGoToMeasurement;
      answer({});
    } else if (measures_) {
      return;  // takes no other command
    } else if (message.id == xbus::kRequestDeviceId) {
      constexpr std::array<std::byte, 4> kDevice{std::byte{0x03}, std::byte{0x80}, std::byte{0x00}, std::byte{0x01}};
      answer(kDevice);
    } else if (message.id == xbus::kSetOutputConfiguration && message.data.size() % 4 == 0) {
      answer(configured(message.data));
    } else {
      constexpr std::byte kInvalidMessage{0x04};
      append(imu::write_xbus({xbus::kError, std::span(&kInvalidMessage, 1)}), out);
    }
  }

  /// Takes the outputs, and returns the list with the rates that it makes of them.
  std::vector<std::byte> configured(std::span<const std::byte> list) {
    std::vector<std::byte> promise(list.begin(), list.end());
    outputs_.clear();
    for (std::size_t at = 0; at < list.size(); at += 4) {
      imu::XsensOutput output{load_be<std::uint16_t>(list, at), load_be<std::uint16_t>(list, at + 2)};
      if (output.rate_hz != imu::mt::kFastest) {
        part_ = static_cast<std::uint64_t>(std::max(1, (rate_hz_ + output.rate_hz / 2) / std::max<int>(1, output.rate_hz)));
        output.rate_hz = static_cast<std::uint16_t>(rate_hz_ / static_cast<int>(part_));
        store_be(std::span(promise), at + 2, output.rate_hz);
      }
      outputs_.push_back(output);
    }
    return promise;
  }

  std::uint16_t rate_hz_;
  transport::ByteFrames<imu::Xbus> frames_;
  std::vector<imu::XsensOutput> outputs_;
  bool measures_ = true;
  std::uint64_t part_ = 1;  // of the samples, which is sent
  std::uint64_t index_ = 0;
  std::uint16_t count_ = 0;
  std::optional<Stamp> first_;
};

/// A MicroStrain sensor: imu-serial.md §B.2.
class EmulatedMip : public EmulatedImu {
 public:
  explicit EmulatedMip(int rate_hz) : rate_hz_(static_cast<std::uint16_t>(rate_hz)) {
    namespace mip = imu::mip;
    outputs_ = {{mip::kReferenceTime}, {mip::kDeltaReferenceTime}, {mip::kAcceleration}, {mip::kTurnRate}};
  }

  void hear(std::span<const std::byte> bytes, std::string& out) override {
    frames_.add(bytes, [&](std::span<const std::byte> frame) { obey(imu::Mip::parse(frame), out); });
  }

  bool sample(const ImuSample& sample, std::string& out) override {
    first_ = first_.value_or(sample.stamp);
    if (idle_ || !streams_ || index_++ % outputs_.front().decimation != 0) {
      return false;
    }
    const Duration since_last = last_ ? sample.stamp - *last_ : Duration(1'000'000'000 / rate_hz_);
    last_ = sample.stamp;
    const Duration on_for = std::chrono::seconds(100) + (sample.stamp - *first_);
    append(imu::write_sample(outputs_, {static_cast<std::uint64_t>(on_for.count()), static_cast<std::uint64_t>(since_last.count()),
                                   sample.specific_force_mps2, sample.angular_rate_radps}), out);
    return true;
  }

 private:
  void obey(const imu::MipPacket& packet, std::string& out) {
    imu::MipFields fields(packet.payload);
    imu::MipField field;
    std::vector<std::byte> reply;
    const auto add = [&](std::initializer_list<std::uint8_t> values) {
      for (const std::uint8_t value : values) {
        reply.push_back(std::byte{value});
      }
    };
    while (fields.next(field)) {
      const std::uint8_t code = obey(packet.set, field);
      add({4, imu::mip::kAckField, field.descriptor, code});
      if (packet.set == imu::mip::kSensorCommands && field.descriptor == imu::mip::kBaseRate && code == kOk) {
        add({5, imu::mip::kBaseRateReply, imu::mip::kSensorData, static_cast<std::uint8_t>(rate_hz_ >> 8),
             static_cast<std::uint8_t>(rate_hz_ & 0xFF)});
      }
    }
    if (!reply.empty() && reply.size() <= 255) {
      append(imu::write_mip({packet.set, reply}), out);
    }
  }

  std::uint8_t obey(std::uint8_t set, const imu::MipField& field) {
    namespace mip = imu::mip;
    if (set == mip::kBaseCommands) {
      idle_ = field.descriptor == mip::kIdle || (idle_ && field.descriptor != mip::kResume);
      const bool known = field.descriptor == mip::kPing || field.descriptor == mip::kIdle || field.descriptor == mip::kResume;
      return known ? kOk : kUnknown;
    }
    if (set != mip::kSensorCommands) {
      return kUnknown;
    }
    const auto is_for_samples = [&](std::size_t at) { return field.data.size() > at && field.data[at] == std::byte{mip::kSensorData}; };
    switch (field.descriptor) {
      case mip::kBaseRate: return is_for_samples(0) ? kOk : kBadParameter;
      case mip::kMessageFormat: return is_for_samples(1) ? set_format(field.data.subspan(2)) : kBadParameter;
      case mip::kDataStream:
        if (!is_for_samples(1) || field.data.size() != 3) {
          return kBadParameter;
        }
        streams_ = field.data[2] != std::byte{0};
        return kOk;
      default: return kUnknown;
    }
  }

  std::uint8_t set_format(std::span<const std::byte> list) {
    namespace mip = imu::mip;
    constexpr std::array kKnown{mip::kReferenceTime, mip::kDeltaReferenceTime, mip::kAcceleration, mip::kTurnRate};
    std::vector<imu::MipOutput> outputs;
    if (list.empty() || list.size() != 1 + std::size_t{3} * load_be<std::uint8_t>(list, 0) || list.size() == 1) {
      return kBadParameter;
    }
    for (std::size_t at = 1; at < list.size(); at += 3) {
      const imu::MipOutput output{load_be<std::uint8_t>(list, at), load_be<std::uint16_t>(list, at + 1)};
      if (std::find(kKnown.begin(), kKnown.end(), output.descriptor) == kKnown.end() || output.decimation == 0) {
        return kBadParameter;  // a model without overrange flags
      }
      outputs.push_back(output);
    }
    outputs_ = outputs;
    return kOk;
  }

  static constexpr std::uint8_t kOk = 0;
  static constexpr std::uint8_t kUnknown = 1;
  static constexpr std::uint8_t kBadParameter = 3;

  std::uint16_t rate_hz_;
  transport::ByteFrames<imu::Mip> frames_;
  std::vector<imu::MipOutput> outputs_;
  bool idle_ = false;
  bool streams_ = true;
  std::uint64_t index_ = 0;
  std::optional<Stamp> first_;
  std::optional<Stamp> last_;
};

}  // namespace

std::unique_ptr<EmulatedImu> emulated_imu(imu::Protocol protocol, int rate_hz) {
  switch (protocol) {
    case imu::Protocol::kXsens: return std::make_unique<EmulatedXsens>(rate_hz);
    case imu::Protocol::kMip: return std::make_unique<EmulatedMip>(rate_hz);
    default: return std::make_unique<EmulatedRows>();
  }
}

std::string row_of(const ImuSample& sample) {
  std::array<char, 256> buffer;
  char* const end = buffer.data() + buffer.size();
  char* at = std::to_chars(buffer.data(), end, sample.stamp.time_since_epoch().count()).ptr;
  for (const Eigen::Vector3d* vector : {&sample.angular_rate_radps, &sample.specific_force_mps2}) {
    for (const double value : *vector) {
      *at++ = ',';
      at = std::to_chars(at, end, value).ptr;
    }
  }
  *at++ = '\n';
  return {buffer.data(), static_cast<std::size_t>(at - buffer.data())};
}

}  // namespace slamd::replay
