#include "tools/simulate/simulated_source.hpp"

#include <cmath>

#include "daemon/configuration/loader.hpp"

namespace slamd::simulate {

SimulatedSource::SimulatedSource(const Scene& scene) : stream_(scene), imu_(scene.imu()),
      wheels_(scene.motion(), kWheel_hz, scene.drive().wheel_errors, scene.drive().seed) {
  if (scene.drive().faults) {
    injector_.emplace(*scene.drive().faults, std::ceil(scene.motion().duration_s()));
  }
}

bool SimulatedSource::next(recording::Packet& packet) {
  const SentPacket* sent = nullptr;
  if (!injector_) {
    return stream_.next(sent) && (packet = packet_of(*sent), true);
  }
  const auto keep = [&](const recording::Packet& damaged) {
    damaged_.push_back({damaged, {damaged.payload.begin(), damaged.payload.end()}});
  };
  if (!damaged_.empty()) {
    damaged_.pop_front();
  }
  while (damaged_.empty() && more_) {
    more_ = stream_.next(sent);
    if (more_) {
      injector_->add(packet_of(*sent), keep);
    } else {
      injector_->finish(keep);
    }
  }
  if (damaged_.empty()) {
    return false;
  }
  packet = damaged_.front().packet;
  packet.payload = damaged_.front().payload;
  return true;
}

bool SimulatedSource::next_imu(sensor::ImuSample& sample) {
  double t_s = 0.0;
  InertialReading reading;
  while (imu_.next(t_s, reading)) {
    sample = written_sample(t_s, reading);
    if (!injector_ || injector_->pass(sample)) {
      return true;
    }
  }
  return false;
}

bool SimulatedSource::next_wheel(sensor::WheelSample& sample) {
  double t_s = 0.0;
  WheelReading reading;
  if (!wheels_.next(t_s, reading)) {
    return false;
  }
  sample = written_sample(t_s, reading);
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
