#include "tools/simulate/scene.hpp"

#include <cstdlib>

#include "tools/simulate/driven_vehicle.hpp"

namespace slamd::simulate {

namespace {

constexpr double kHourOffset_s = 13.0 * 60.0 + 20.0;  // of kStart_unix_s

std::unique_ptr<Scenery> scenery_of(const Drive& drive) {
  auto scenery = drive.mesh.empty() ? make_scenery(drive.world, drive.seed, drive.extras)
                                    : std::make_unique<Scenery>(make_mesh_world(drive.mesh, drive.seed));
  if (!drive.waypoints.empty()) {
    scenery->set_corners(drive.waypoints);
  }
  return scenery;
}

/// A number as it comes out of a file that holds it with so many decimals.
double through_text(double value, const char* format) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return std::strtod(text, nullptr);
}

Motion motion_of(const Scenery& scenery, const Drive& drive) {
  const Ride ride = ride_of(drive);
  if (!drive.driven) {
    return simulate::drive(scenery.route(), ride, drive.seed);
  }
  const Place start = start_of(scenery.route(), ride, drive.seed);
  Body body(scenery.route(), ride, drive.seed);
  return standing(body.next(start.position_m, start.yaw_rad, 0.0, 0.0), ride, drive.seed);
}

}  // namespace

Stamp stamp_at(double t_s) { return Stamp{} + std::chrono::seconds(kStart_unix_s) + from_seconds(t_s); }

Ride ride_of(const Drive& drive) {
  return {drive.vehicle,         drive.duration_s,     drive.speed_mps,     drive.rest_s, base_height_m(drive.vehicle),
          drive.turn_rate_radps, drive.bumps_per_100m, drive.vibration_mps2};
}

recording::Packet packet_of(const SentPacket& sent) {
  return {stamp_at(sent.sent_s), sent.source_address, sent.source_port, sent.destination_port, sent.payload};
}

sensor::ImuSample written_sample(double t_s, const InertialReading& reading) {
  sensor::ImuSample sample;
  sample.stamp = stamp_at(t_s);
  for (int axis = 0; axis < 3; ++axis) {
    sample.angular_rate_radps[axis] = through_text(reading.rate_radps[axis], kRateFormat);
    sample.specific_force_mps2[axis] = through_text(reading.force_mps2[axis], kForceFormat);
  }
  return sample;
}

sensor::WheelSample written_sample(double t_s, const WheelReading& reading) {
  return {stamp_at(t_s), through_text(reading.v_mps, kSpeedFormat), through_text(reading.w_radps, kTurnRateFormat)};
}

Scene::Scene(const Drive& drive)
    : drive_(drive),
      mounting_(mounting_of(drive.lidar)),
      scenery_(scenery_of(drive)),
      motion_(std::make_unique<Motion>(motion_of(*scenery_, drive))) {
  const RangeErrors errors = range_errors_of(drive);
  SpinningSettings settings{SpinningKind::kVlp16, drive.dual, kHourOffset_s, kStart_unix_s};
  switch (drive.lidar) {
    case LidarKind::kLivoxAvia:
      avia_.emplace(world(), motion(), mounting_.T_base_lidar, errors, drive.seed,
                    LivoxSettings{drive.returns, drive.pattern, drive.spherical});
      return;
    case LidarKind::kLivoxMid360:
      mid360_.emplace(world(), motion(), mounting_.T_base_lidar, errors, drive.seed);
      return;
    case LidarKind::kVlp16: break;
    case LidarKind::kVlp32c: settings.kind = SpinningKind::kVlp32c; break;
    case LidarKind::kHdl32e: settings.kind = SpinningKind::kHdl32e; break;
  }
  spinning_.emplace(world(), motion(), mounting_.T_base_lidar, errors, drive.seed, settings);
}

const PacketMaker& Scene::lidar() const {
  if (spinning_) {
    return *spinning_;
  }
  if (avia_) {
    return *avia_;
  }
  return *mid360_;
}

InertialSensor Scene::imu() const {
  return {motion(), mounting_.T_base_imu, drive_.imu_rate_hz, drive_.imu_errors, drive_.seed};
}

double Scene::path_m() const {
  double length = 0.0;
  Eigen::Vector3d last = motion().pose_at(0.0).translation();
  for (double t = 0.1; t <= motion().duration_s(); t += 0.1) {
    const Eigen::Vector3d now = motion().pose_at(t).translation();
    length += (now - last).norm();
    last = now;
  }
  return length;
}

}  // namespace slamd::simulate
