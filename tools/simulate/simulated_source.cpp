#include "tools/simulate/simulated_source.hpp"

#include <cstdlib>

#include "daemon/configuration/loader.hpp"

namespace slamd::simulate {

namespace {

/// A number as it comes out of a file that holds it with so many decimals.
double through_text(double value, const char* format) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return std::strtod(text, nullptr);
}

}  // namespace

bool SimulatedSource::next(recording::Packet& packet) {
  const SentPacket* sent = nullptr;
  if (!stream_.next(sent)) {
    return false;
  }
  packet.received = stamp_at(sent->sent_s);
  packet.source_address = sent->source_address;
  packet.source_port = sent->source_port;
  packet.destination_port = sent->destination_port;
  packet.payload = sent->payload;
  return true;
}

bool SimulatedSource::next_imu(sensor::ImuSample& sample) {
  double t_s = 0.0;
  InertialReading reading;
  if (!imu_.next(t_s, reading)) {
    return false;
  }
  sample = {};
  sample.stamp = stamp_at(t_s);
  for (int axis = 0; axis < 3; ++axis) {
    sample.angular_rate_radps[axis] = through_text(reading.rate_radps[axis], kRateFormat);
    sample.specific_force_mps2[axis] = through_text(reading.force_mps2[axis], kForceFormat);
  }
  return true;
}

bool SimulatedSource::next_wheel(sensor::WheelSample& sample) {
  double t_s = 0.0;
  WheelReading reading;
  if (!wheels_.next(t_s, reading)) {
    return false;
  }
  sample = {stamp_at(t_s), through_text(reading.v_mps, "%.5f"), through_text(reading.w_radps, "%.6f")};
  return true;
}

evaluation::Trajectory truth_of(const Motion& motion) {
  evaluation::Trajectory truth;
  for (int i = 0; i <= static_cast<int>(motion.duration_s() * kTruth_hz); ++i) {
    truth.push_back({stamp_at(i / kTruth_hz), motion.pose_at(i / kTruth_hz)});
  }
  return truth;
}

configuration::Configuration configuration_of(const Drive& drive, const std::vector<std::string>& overrides) {
  configuration::Loader loader;
  loader.add_text(recording_toml(drive), "recording.toml");
  for (const std::string& key_value : overrides) {
    loader.add_override(key_value);
  }
  return loader.load();
}

}  // namespace slamd::simulate
