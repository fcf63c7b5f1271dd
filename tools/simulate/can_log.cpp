#include "tools/simulate/can_log.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/base/assert.hpp"
#include "drivers/recording/candump.hpp"
#include "tools/simulate/text_file.hpp"

namespace slamd::simulate {

using can::CanSignal;
using transport::CanFrame;

namespace {

constexpr const char* kInterface = "can0";
constexpr std::uint32_t kWheelId = 0x1A0;
/// What a frame takes on the bus, and between two of a sensor.
constexpr Duration kFrameTime = std::chrono::microseconds(200);
constexpr Duration kWheelDelay = std::chrono::microseconds(500);

constexpr Duration kXsensTick = std::chrono::microseconds(100);
constexpr std::uint32_t kXsensSwitchedOn = 0xFFFF'F000;  // ticks at the time base's origin: they wrap in the drive's first second

constexpr Duration kAceinnaLatency = std::chrono::microseconds(3000);
constexpr std::uint8_t kAceinnaLatencyCode = 6;  // of 0.5 ms
constexpr std::uint32_t kAceinnaForce = 0x08F02D80;
constexpr std::uint32_t kAceinnaRate = 0x0CF02A80;

CanFrame frame(std::uint32_t id, std::uint8_t size, Stamp received) {
  return {.id = id, .is_extended = id > 0x7FF, .size = size, .data = {}, .received = received};
}

/// Puts a number at a byte of the frame.
void put(CanFrame& frame, int byte, int bytes, bool is_big, bool is_signed, double scale, double offset, double value) {
  const int first_bit = 8 * byte + (is_big ? 7 : 0);
  can::put_value({frame.id, frame.is_extended, is_big, first_bit, 8 * bytes, is_signed, scale, offset}, value, frame);
}

std::string signal_toml(const CanSignal& signal) {
  return "{ id = " + std::to_string(signal.id) + ", first_bit = " + std::to_string(signal.first_bit) + ", bits = " +
         std::to_string(signal.bits) + ", signed = " + (signal.is_signed ? "true" : "false") + ", scale = 0.001 }";
}

}  // namespace

CanImu::Frames CanImu::frames_of(const sensor::ImuSample& sample) {
  SLAMD_ASSERT(protocol_ == imu::Protocol::kXsens || protocol_ == imu::Protocol::kAceinna);
  return protocol_ == imu::Protocol::kXsens ? xsens(sample) : aceinna(sample);
}

CanImu::Frames CanImu::xsens(const sensor::ImuSample& sample) {
  const auto ticks = static_cast<std::uint32_t>(kXsensSwitchedOn + static_cast<std::uint64_t>((sample.stamp - stamp_at(0.0)) / kXsensTick));
  Stamp arrival = sample.stamp;
  const auto next = [&](std::uint32_t id, std::uint8_t size) { return frame(id, size, arrival += kFrameTime); };
  CanFrame time = next(0x005, 4);
  CanFrame counter = next(0x006, 2);
  CanFrame rate = next(0x032, 6);
  CanFrame force = next(0x034, 6);
  put(time, 0, 4, true, false, 1.0, 0.0, ticks);
  put(counter, 0, 2, true, false, 1.0, 0.0, counter_++);
  for (int axis = 0; axis < 3; ++axis) {
    put(rate, 2 * axis, 2, true, true, 1.0 / 512.0, 0.0, sample.angular_rate_radps[axis]);
    put(force, 2 * axis, 2, true, true, 1.0 / 256.0, 0.0, sample.specific_force_mps2[axis]);
  }
  Frames frames;
  for (const CanFrame& one : {time, counter, rate, force}) {
    frames.push_back(one);
  }
  return frames;
}

CanImu::Frames CanImu::aceinna(const sensor::ImuSample& sample) {
  constexpr int kOnWire[] = {1, 0, 2};
  CanFrame force = frame(kAceinnaForce, 8, sample.stamp + kAceinnaLatency - kFrameTime);
  CanFrame rate = frame(kAceinnaRate, 8, sample.stamp + kAceinnaLatency);
  for (int place = 0; place < 3; ++place) {
    put(force, 2 * place, 2, false, false, 0.01, -320.0, sample.specific_force_mps2[kOnWire[place]]);
    put(rate, 2 * place, 2, false, false, 1.0 / 128.0, -250.0, sample.angular_rate_radps[kOnWire[place]] * 180.0 / M_PI);
  }
  force.data[7] = rate.data[7] = std::byte{kAceinnaLatencyCode};
  Frames frames;
  frames.push_back(force);
  frames.push_back(rate);
  return frames;
}

can::WheelSignals wheel_signals(double track_m) {
  const CanSignal left{.id = kWheelId, .first_bit = 0, .bits = 16, .is_signed = true, .scale = 0.001};
  CanSignal right = left;
  right.first_bit = 16;
  return {can::WheelModel::kDifferential, {left, right}, track_m};
}

CanFrame wheel_frame(const can::WheelSignals& signals, const WheelReading& reading, Stamp stamp) {
  CanFrame both = frame(kWheelId, 4, stamp + kWheelDelay);
  can::put_value(signals.signals[0], reading.left_mps, both);
  can::put_value(signals.signals[1], reading.right_mps, both);
  return both;
}

std::string can_toml(const Drive& drive) {
  const can::WheelSignals wheels = wheel_signals(drive.wheel_errors.track_m);
  char track[32];
  std::snprintf(track, sizeof track, "%.3f", wheels.base_m);
  return std::string("\n[wheel]\nsource = \"can.log\"\ntrack_m = ") + track + "\nleft = " + signal_toml(wheels.signals[0]) +
         "\nright = " + signal_toml(wheels.signals[1]) + "\n\n[imu]\nsource = \"can.log\"\nprotocol = \"" + name_of(*drive.can) + "\"\n";
}

void write_can_log(const Scene& scene, const std::filesystem::path& file) {
  const Drive& drive = scene.drive();
  TextFile out(file);
  const auto write = [&](const CanFrame& one) { std::fputs(recording::candump_line(kInterface, one).c_str(), out.stream()); };
  const can::WheelSignals signals = wheel_signals(drive.wheel_errors.track_m);
  WheelSensor wheels(scene.motion(), kWheel_hz, drive.wheel_errors, drive.seed);
  std::optional<CanFrame> wheel;
  const auto next_wheel = [&] {
    double t_s = 0.0;
    WheelReading reading;
    wheel = wheels.next(t_s, reading) ? std::optional(wheel_frame(signals, reading, stamp_at(t_s))) : std::nullopt;
  };
  CanImu encoder(*drive.can);
  InertialSensor sensor = scene.imu();
  double t_s = 0.0;
  next_wheel();
  for (InertialReading reading; sensor.next(t_s, reading);) {
    for (const CanFrame& one : encoder.frames_of(written_sample(t_s, reading))) {
      for (; wheel && wheel->received <= one.received; next_wheel()) {
        write(*wheel);
      }
      write(one);
    }
  }
  for (; wheel; next_wheel()) {
    write(*wheel);
  }
  out.close();
}

}  // namespace slamd::simulate
