#include "tools/simulate/drive.hpp"

#include <nlohmann/json.hpp>

#include "tools/simulate/can_log.hpp"

namespace slamd::simulate {

using nlohmann::ordered_json;

namespace {

std::string transform_toml(const geometry::Se3& T) {
  const Eigen::Vector3d& p = T.translation();
  char text[160];
  std::snprintf(text, sizeof text, "{ xyz_m = [%.5f, %.5f, %.5f], rpy_deg = [0.0, 0.0, 0.0] }", p.x(), p.y(), p.z());
  return text;
}

const char* name_of_vehicle(VehicleKind vehicle) {
  switch (vehicle) {
    case VehicleKind::kAckermann: return "ackermann";
    case VehicleKind::kSkidSteer: return "skid_steer";
    case VehicleKind::kHandheld: return "handheld";
  }
  return "?";
}

const char* name_of_returns(const Drive& drive) {
  if (drive.lidar != LidarKind::kLivoxAvia) {
    return drive.dual ? "dual" : "strongest";
  }
  switch (drive.returns) {
    case LivoxReturns::kFirst: return "first";
    case LivoxReturns::kStrongest: return "strongest";
    case LivoxReturns::kDual: return "dual";
    case LivoxReturns::kTriple: return "triple";
  }
  return "?";
}

}  // namespace

const char* name_of(LidarKind lidar) {
  switch (lidar) {
    case LidarKind::kVlp16: return "vlp16";
    case LidarKind::kVlp32c: return "vlp32c";
    case LidarKind::kHdl32e: return "hdl32e";
    case LidarKind::kLivoxAvia: return "livox_avia";
    case LidarKind::kLivoxMid360: return "livox_mid360";
  }
  return "?";
}

Mounting mounting_of(LidarKind lidar) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const geometry::Se3 antenna(I, {-0.15, 0.0, 0.45});
  if (lidar == LidarKind::kLivoxAvia) {
    return {{I, {0.04165, 0.02326, -0.0284}}, {I, {-0.06, 0.03, -0.08}}, antenna};
  }
  return {{I, {0.12, 0.0, 0.26}}, {I, {0.0, 0.0, 0.0}}, antenna};
}

RangeErrors range_errors_of(const Drive& drive) {
  RangeErrors errors;
  switch (drive.lidar) {
    case LidarKind::kVlp16: break;
    case LidarKind::kHdl32e: break;
    case LidarKind::kVlp32c: errors = {.max_range_m = 200.0, .min_range_m = 1.0, .full_signal = 4e-6}; break;
    case LidarKind::kLivoxAvia: errors = {0.015, 0.004, 190.0, 1.0, 3e-6}; break;
    case LidarKind::kLivoxMid360: errors = {0.015, 0.0, 70.0, 0.1, 4e-5}; break;
  }
  errors.noise_m = drive.range_noise_m.value_or(errors.noise_m);
  errors.beam_bias_m = drive.beam_bias_m.value_or(errors.beam_bias_m);
  errors.mixed_pixels = drive.mixed_pixels;
  errors.drops_per_m = drive.drops_per_m;
  return errors;
}

double base_height_m(VehicleKind vehicle) { return vehicle == VehicleKind::kHandheld ? 1.3 : 0.45; }

std::string recording_toml(const Drive& drive) {
  const Mounting mounting = mounting_of(drive.lidar);
  const std::string sensors = drive.can ? can_toml(drive) : "\n[wheel]\nsource = \"odom.csv\"\n\n[imu]\nsource = \"imu.csv\"\n";
  return "# Simulated; simulation.json has every parameter.\n[[lidar]]\nmodel = \"" +
         std::string(name_of(drive.lidar)) +
         "\"\nsource = \"lidar.pcap\"\nT_base_lidar = " + transform_toml(mounting.T_base_lidar) +
         "\n" + sensors + "T_base_imu = " + transform_toml(mounting.T_base_imu) + "\n\n[gnss]\nuse = false\nsource = \"gnss.csv\"\nT_base_antenna = " +
         transform_toml(mounting.T_base_antenna) + "\n";
}

std::string parameters_json(const Drive& drive) {
  const RangeErrors range = range_errors_of(drive);
  const InertialErrors& imu = drive.imu_errors;
  const WheelErrors& wheel = drive.wheel_errors;
  const GnssErrors& gnss = drive.gnss_errors;
  ordered_json json;
  json["world"] = drive.mesh.empty() ? drive.world : drive.mesh.string();
  json["lidar"] = name_of(drive.lidar);
  json["returns"] = name_of_returns(drive);
  if (drive.lidar == LidarKind::kLivoxAvia) {
    json["scan_pattern"] = drive.pattern == RisleyPattern::kRepetitive ? "repetitive" : "non_repetitive";
    json["coordinates"] = drive.spherical ? "spherical" : "cartesian";
  }
  json["vehicle"] = name_of_vehicle(drive.vehicle);
  if (drive.driven) {
    json["driven"] = true;  // commands.csv has the rest
  }
  json["seed"] = drive.seed;
  json["duration_s"] = drive.duration_s;
  json["speed_mps"] = drive.speed_mps;
  json["rest_s"] = drive.rest_s;
  json["turn_rate_radps"] = drive.turn_rate_radps;
  json["bumps_per_100m"] = drive.bumps_per_100m;
  json["vibration_mps2"] = drive.vibration_mps2;
  json["base_height_m"] = base_height_m(drive.vehicle);
  json["cars"] = drive.extras.cars;
  json["people"] = drive.extras.people;
  for (const Eigen::Vector2d& corner : drive.waypoints) {
    json["waypoints_m"].push_back({corner.x(), corner.y()});
  }
  json["range"] = {{"noise_m", range.noise_m},
                   {"beam_bias_m", range.beam_bias_m},
                   {"max_range_m", range.max_range_m},
                   {"min_range_m", range.min_range_m},
                   {"full_signal", range.full_signal},
                   {"mixed_pixels", range.mixed_pixels},
                   {"divergence_rad", range.divergence_rad},
                   {"drops_per_m", range.drops_per_m}};
  if (drive.can) {
    json["can"] = name_of(*drive.can);
  }
  json["imu"] = {{"rate_hz", drive.imu_rate_hz},
                 {"gyro_noise_radps_sqrthz", imu.gyro_noise_radps_sqrthz},
                 {"accel_noise_mps2_sqrthz", imu.accel_noise_mps2_sqrthz},
                 {"gyro_bias_radps", imu.gyro_bias_radps},
                 {"accel_bias_mps2", imu.accel_bias_mps2},
                 {"gyro_walk_radps2_sqrthz", imu.gyro_walk_radps2_sqrthz},
                 {"accel_walk_mps3_sqrthz", imu.accel_walk_mps3_sqrthz},
                 {"scale", imu.scale},
                 {"misalignment_rad", imu.misalignment_rad},
                 {"gyro_step_radps", imu.gyro_step_radps},
                 {"accel_step_mps2", imu.accel_step_mps2},
                 {"gyro_limit_radps", imu.gyro_limit_radps},
                 {"accel_limit_mps2", imu.accel_limit_mps2},
                 {"gyro_per_degree_radps", imu.gyro_per_degree_radps},
                 {"start_temp_c", imu.start_temp_c},
                 {"warm_up_c", imu.warm_up_c}};
  json["wheel"] = {
      {"track_m", wheel.track_m}, {"ticks_per_m", wheel.ticks_per_m},     {"scale", wheel.scale},
      {"noise", wheel.noise},     {"slip_in_turns", wheel.slip_in_turns}, {"slip_chance", wheel.slip_chance}};
  json["gnss"] = {{"drift_m", gnss.drift_m},
                  {"drift_s", gnss.drift_s},
                  {"noise_m", gnss.noise_m},
                  {"multipath_chance", gnss.multipath_chance},
                  {"multipath_m", gnss.multipath_m},
                  {"outage_chance", gnss.outage_chance},
                  {"covered", gnss.covered},
                  {"origin_lat_deg", kOriginLatitude_deg},
                  {"origin_lon_deg", kOriginLongitude_deg},
                  {"origin_alt_m", kOriginAltitude_m}};
  return json.dump(2) + "\n";
}

}  // namespace slamd::simulate
