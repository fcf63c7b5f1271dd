// Any bytes as messages of a CAN socket, and so as frames for all readers; as signals of any place in a frame; and as
// lines of a candump log.
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/assert.hpp"
#include "drivers/can/aceinna_imu.hpp"
#include "drivers/can/wheel_signals.hpp"
#include "drivers/can/xsens_can.hpp"
#include "drivers/recording/candump.hpp"
#include "drivers/transport/can_socket.hpp"

namespace {

using namespace slamd;
using can::CanSignal;
using transport::CanFrame;
using transport::CanSocket;

/// All that reads frames.
class Readers {
 public:
  void take(const CanFrame& frame) {
    sensor::ImuReading reading;
    if (xsens_.take(frame, reading)) {
      check(reading);
    }
    if (aceinna_.take(frame, reading)) {
      check(reading);
    }
    sensor::WheelSample sample;
    for (can::WheelReader* wheels : {&sides_, &car_}) {
      if (wheels->take(frame, sample)) {
        SLAMD_ASSERT(std::isfinite(sample.speed_mps) && std::abs(sample.turn_rate_radps) <= 10.0);
      }
    }
    ++frames_;
  }

  /// An Xsens' sample takes three frames, an Aceinna's two.
  void check_counts() const {
    SLAMD_ASSERT(3 * xsens_.counters().of(imu::InertialResult::kSample) <= frames_);
    SLAMD_ASSERT(2 * aceinna_.counters().of(imu::InertialResult::kSample) <= frames_);
    SLAMD_ASSERT(sides_.of(can::WheelResult::kSample) + sides_.of(can::WheelResult::kOther) <= frames_);
  }

 private:
  static void check(const sensor::ImuReading& reading) {
    SLAMD_ASSERT(reading.angular_rate_radps.allFinite() && reading.specific_force_mps2.allFinite());
  }

  static constexpr CanSignal kLeft{.id = 0x1A0, .is_signed = true, .scale = 0.001};
  static constexpr CanSignal kRight{.id = 0x1A1, .is_big_endian = true, .first_bit = 7, .bits = 13, .is_signed = true, .scale = 0.01};

  can::XsensCanReader xsens_;
  can::AceinnaReader aceinna_;
  can::WheelReader sides_{{can::WheelModel::kDifferential, {kLeft, kRight}, 0.6}};
  can::WheelReader car_{{can::WheelModel::kAckermann, {kLeft, kRight}, 2.5}};
  std::uint64_t frames_ = 0;
};

/// As if the kernel had brought these messages.
void check_socket(std::span<const std::byte> input) {
  static const transport::HostClock clock;
  int ends[2];
  SLAMD_ASSERT(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, ends) == 0);
  CanSocket socket(ends[1], "fuzz", clock);
  Readers readers;
  std::uint64_t visited = 0;
  std::uint64_t messages = 0;
  const auto take = [&] {
    while (socket.receive([&](const CanFrame& frame) {
      SLAMD_ASSERT(frame.size <= 8 && frame.id <= (frame.is_extended ? CAN_EFF_MASK : CAN_SFF_MASK));
      readers.take(frame);
      ++visited;
    }) > 0) {
    }
  };
  for (std::span<const std::byte> rest = input; !rest.empty(); ++messages) {
    const std::size_t size = std::min(rest.size(), sizeof(can_frame));
    SLAMD_ASSERT(send(ends[0], rest.data(), size, 0) == static_cast<ssize_t>(size));
    rest = rest.subspan(size);
    if (messages % 4 == 3) {
      take();
    }
  }
  take();
  const transport::CanCounters counters = socket.counters();
  SLAMD_ASSERT(counters.received == visited && counters.received + counters.other <= messages);
  readers.check_counts();
  close(ends[0]);
}

/// A number that was read is written back as the same bits.
void check_signal(std::span<const std::byte> input) {
  if (input.size() < 13) {
    return;
  }
  const auto byte = [&](std::size_t i) { return std::to_integer<int>(input[i]); };
  CanSignal signal{.id = 1, .is_big_endian = (byte(0) & 1) != 0, .first_bit = byte(1) % 80 - 8, .bits = byte(2) % 72,
                   .is_signed = (byte(0) & 2) != 0, .scale = byte(3) - 128.0, .offset = byte(4) - 128.0};
  CanFrame frame{.id = 1, .is_extended = false, .size = 8, .data = {}, .received = {}};
  std::copy_n(input.begin() + 5, 8, frame.data.begin());
  if (!signal.is_valid()) {
    return;
  }
  const auto value = value_of(signal, frame);
  SLAMD_ASSERT(value && std::isfinite(*value));
  CanFrame again = frame;
  put_value(signal, *value, again);
  SLAMD_ASSERT(signal.bits > 40 || again.data == frame.data);  // of more, a double does not know the last
}

/// A line that is taken for a frame is written as one that says the same.
void check_log(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    CanFrame frame;
    std::string_view interface;
    if (recording::parse_candump(line, frame, interface) != recording::CanLine::kFrame || frame.received < Stamp{}) {
      continue;
    }
    SLAMD_ASSERT(frame.size <= 8 && !interface.empty());
    std::string written = recording::candump_line(interface, frame);
    written.pop_back();
    CanFrame again;
    SLAMD_ASSERT(recording::parse_candump(written, again, interface) == recording::CanLine::kFrame);
    SLAMD_ASSERT(again.id == frame.id && again.is_extended == frame.is_extended && again.size == frame.size && again.data == frame.data);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  check_socket(input);
  check_signal(input);
  check_log({reinterpret_cast<const char*>(bytes), size});
  can::parse_axis_map({reinterpret_cast<const char*>(bytes), size});
  return 0;
}
