#include "tools/simulate/options.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "daemon/bus/channels.hpp"
#include "drivers/recording/packet.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::simulate {

namespace {

constexpr const char* kPlace = "World and tour";
constexpr const char* kSensors = "Sensors";
constexpr const char* kOutput = "Output";
constexpr const char* kLive = "Live";

/// Reads corners "x,y" a line (m); closes the tour.
std::vector<Eigen::Vector2d> read_waypoints(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw recording::RecordingError(file, "cannot be read");
  }
  std::vector<Eigen::Vector2d> corners;
  int number = 0;
  for (std::string line; std::getline(stream, line); ++number) {
    std::istringstream words(line);
    double x = 0.0;
    double y = 0.0;
    char comma = 0;
    if (words >> x >> comma >> y && comma == ',') {
      corners.emplace_back(x, y);
    } else if (number > 0 && !line.empty()) {
      throw cli::UsageError(file + ":" + std::to_string(number + 1) + ": is no way-point (x,y)");
    }
  }
  if (corners.size() < 3) {
    throw cli::UsageError(file + ": holds fewer than three way-points");
  }
  if ((corners.front() - corners.back()).norm() > 1e-6) {
    corners.push_back(corners.front());
  }
  return corners;
}

/// Errors: UsageError for live options that do not go together.
void check_live(const Options& options, const Drive& drive) {
  const bool driven = options.live || !options.drive_to.empty();
  const bool asks = options.json || !(options.imu_to.empty() && options.gnss_to.empty() && options.can_to.empty() && options.lcm_url.empty() && options.lcm_prefix.empty());
  if (!driven && asks) {
    throw cli::UsageError("--imu-to, --gnss-to, --can-to, --url, --prefix and --json are of use with --drive or --live");
  }
  if (!options.can_to.empty() && options.can.empty()) {
    throw cli::UsageError("--can-to needs --can: what the inertial sensor speaks");
  }
  if (!options.live && !options.device_code.empty()) {
    throw cli::UsageError("--device-code is of use with --live");
  }
  if (!options.live && !options.device_extrinsic.empty()) {
    throw cli::UsageError("--device-extrinsic is of use with --live");
  }
  if (options.pps && !(options.live && drive.lidar == LidarKind::kLivoxAvia)) {
    throw cli::UsageError("--pps is of use with --live and an Avia");
  }
  if (options.live && drive.lidar != LidarKind::kLivoxAvia && drive.lidar != LidarKind::kLivoxMid360) {
    throw cli::UsageError("--live: " + options.lidar + " has nothing to say to a host; --drive sends its packets");
  }
  if (options.device_code.size() > 16) {
    throw cli::UsageError("--device-code " + options.device_code + ": must be up to 16 characters");
  }
}

}  // namespace

void declare(const cli::Command& app, Options& options) {
  const cli::Command output = app.under(kOutput);
  const cli::Command place = app.under(kPlace);
  const cli::Command sensors = app.under(kSensors);
  const cli::Command live = app.under(kLive);
  Drive& drive = options.drive;
  output.option("--out", options.out, "Directory of the recording to be made");
  output.flag("--force", options.force, "Write into a directory that is not empty");
  output.flag("--map", drive.map, "Also write true_map.ply");
  output.flag("--localisability", drive.localisability,
      "Also write localisability.csv: how well the true surfaces hold the position");
  output.option("--preview", options.preview, "Also write a PNG of world, path and one scan");
  output.flag("--replay", options.replay,
      "Map the drive as slamd-replay would, without writing the recording; products go to --out");
  output.option("--threads", drive.threads, "Of the ray casting; any number gives the same bytes").within(1, 64).shows_default();

  place.option("--world", drive.world, "Where to drive").one_of(world_names()).shows_default();
  place.option("--mesh", options.mesh, "A PLY mesh to drive in, in place of a world");
  place.option("--waypoints", options.waypoints, "CSV of x,y (m): the corners of the tour");
  place.option("--seed", drive.seed, "Of world, tour and noise").shows_default();
  place.option("--duration", drive.duration_s, "Length of the drive, s").within(5.0, 3600.0).shows_default();
  place.option("--speed", drive.speed_mps, "Pace, m/s").within(0.1, 10.0).shows_default();
  place.option("--rest", drive.rest_s, "Standing still at the start, s").within(0.0, 60.0).shows_default();
  place.option("--vehicle", options.vehicle, "What drives").one_of({"ackermann", "skid_steer", "handheld"}).shows_default();
  place.option("--turn-rate", options.turn_rate_degps, "Of turns on the spot, °/s").within(5.0, 120.0).shows_default();
  place.option("--bumps", drive.bumps_per_100m, "Cable ramps of 5 cm in 100 m").within(0.0, 50.0).shows_default();
  place.option("--vibration", drive.vibration_mps2, "Of the body while it moves, m/s² rms").within(0.0, 5.0).shows_default();
  place.option("--cars", drive.extras.cars, "That drive about (town, campus, harbour)").within(0, 100).shows_default();
  place.option("--people", drive.extras.people, "That walk about").within(0, 200).shows_default();

  sensors.option("--lidar", options.lidar, "Sensor").one_of({"vlp16", "vlp32c", "hdl32e", "livox_avia", "livox_mid360"}).shows_default();
  sensors.option("--returns", options.returns, "strongest, dual; Avia: first, strongest, dual, triple")
      .one_of({"first", "strongest", "dual", "triple"});
  sensors.option("--scan-pattern", options.pattern, "Avia: non_repetitive, or a repeated band of 70° × 4.5°")
      .one_of({"non_repetitive", "repetitive"});
  sensors.option("--coordinates", options.coordinates, "Avia: of the points in its packets").one_of({"cartesian", "spherical"});
  sensors.option("--range-noise", options.range_noise_m, "In place of the model's, 1σ, m").within(0.0, 1.0);
  sensors.option("--beam-bias", options.beam_bias_m, "Of each beam, in place of the model's, 1σ, m").within(0.0, 1.0);
  sensors.flag("--mixed-pixels", drive.mixed_pixels, "Beams have a width: edges give points in between, or two echoes");
  sensors.option("--rain", drive.drops_per_m, "Rain or dust: chance of an echo from the air in each metre").within(0.0, 0.2).shows_default();
  sensors.option("--imu-rate", drive.imu_rate_hz, "Of the external inertial sensor, Hz").within(50.0, 1000.0).shows_default();
  sensors.option("--can", options.can, "Inertial sensor and wheels on a CAN bus: also write can.log, and have recording.toml name it")
      .one_of({"xsens", "aceinna"});
  sensors.flag("--perfect-imu", options.perfect_imu, "Inertial sensors without any error");
  sensors.flag("--no-sky", options.covered, "GNSS never has a fix");

  live.option("--drive", options.drive_to,
      "HOST[:DATA_PORT[:POSITION_PORT]]: drive a skid-steered vehicle by velocity commands from LCM in real "
      "time, and send its packets there; --out is then optional")
      .excludes({"--vehicle", "--waypoints", "--replay", "--preview"});
  live.flag("--live", options.live,
      "As --drive, but a Livox is a device on the network: a host finds, sets and starts it, and gets its packets")
      .excludes({"--drive", "--vehicle", "--waypoints", "--replay", "--preview"});
  live.option("--device-code", options.device_code, "With --live: its broadcast code or serial number");
  live.option("--device-extrinsic", options.device_extrinsic,
      "With --live: X,Y,Z,ROLL,PITCH,YAW that is stored in the device (m, °); it moves no point")
      .commas(6)
      .within(-360.0, 360.0);
  live.flag("--pps", options.pps, "With --live, an Avia: a PPS line that beats with the wall clock; told the UTC, it follows GPS");
  live.option("--imu-to", options.imu_to, "Where inertial samples go: udp:HOST:PORT, pty:LINKPATH, or as an emulated sensor sends them, xsens:LINKPATH, mip:LINKPATH");
  live.option("--gnss-to", options.gnss_to, "Where fixes go, as an emulated receiver sends them: nmea:LINKPATH, ubx:LINKPATH, or both:LINKPATH");
  live.option("--can-to", options.can_to, "The CAN interface on which inertial sensor and wheels speak as --can says, such as vcan0");
  live.option("--url", options.lcm_url, "LCM's, for commands and truth").shows_default(std::string(bus::kDefaultUrl));
  live.option("--prefix", options.lcm_prefix, "Of the channels").shows_default(std::string(bus::kDefaultPrefix));
  live.flag("--json", options.json, "Print the counts as JSON");
  declare(app.under("Faults of what the sensors send, told in faults.json"), options.faults);
}

DeviceOptions device_options_of(const Options& options) {
  DeviceOptions device{options.device_code, options.pps, {}};
  for (std::size_t axis = 0; axis < 3 && !options.device_extrinsic.empty(); ++axis) {
    device.extrinsic.xyz_mm[axis] = static_cast<std::int32_t>(std::lround(1e3 * options.device_extrinsic[axis]));
    device.extrinsic.rpy_deg[axis] = static_cast<float>(options.device_extrinsic[3 + axis]);
  }
  return device;
}

LiveOptions live_options_of(const Options& options) {
  LiveOptions live;
  if (!options.live) {
    replay::parse_destination("--drive", options.drive_to, live.target);
  }
  if (!options.imu_to.empty()) {
    replay::parse_imu_destination(options.imu_to, live.target);
    live.target.imu_rate_hz = std::max(1, static_cast<int>(std::lround(options.drive.imu_rate_hz)));
  }
  if (!options.gnss_to.empty()) {
    replay::parse_gnss_destination(options.gnss_to, live.target);
  }
  live.target.can_interface = options.can_to;
  live.lcm_url = options.lcm_url.empty() ? std::string(bus::kDefaultUrl) : options.lcm_url;
  live.lcm_prefix = options.lcm_prefix.empty() ? std::string(bus::kDefaultPrefix) : options.lcm_prefix;
  if (!bus::is_prefix(live.lcm_prefix)) {
    throw cli::UsageError("--prefix: 1 to 40 letters, digits, '_' and '-'");
  }
  live.directory = options.out;
  return live;
}

Drive drive_of(const Options& options) {
  Drive drive = options.drive;
  for (const LidarKind lidar :
       {LidarKind::kVlp16, LidarKind::kVlp32c, LidarKind::kHdl32e, LidarKind::kLivoxAvia, LidarKind::kLivoxMid360}) {
    drive.lidar = options.lidar == name_of(lidar) ? lidar : drive.lidar;
  }
  drive.vehicle = options.vehicle == "handheld"     ? VehicleKind::kHandheld
                  : options.vehicle == "skid_steer" ? VehicleKind::kSkidSteer
                                                    : VehicleKind::kAckermann;
  const bool avia = drive.lidar == LidarKind::kLivoxAvia;
  if ((!avia && (options.returns == "first" || options.returns == "triple")) ||
      (drive.lidar == LidarKind::kLivoxMid360 && options.returns == "dual")) {
    throw cli::UsageError("--returns " + options.returns + ": " + options.lidar + " has no such mode");
  }
  if (!avia && !(options.pattern.empty() && options.coordinates.empty())) {
    throw cli::UsageError("--scan-pattern and --coordinates: " + options.lidar + " has no such setting");
  }
  drive.pattern =
      options.pattern == "repetitive" ? RisleyPattern::kRepetitive : RisleyPattern::kNonRepetitive;
  drive.spherical = options.coordinates == "spherical";
  drive.dual = !avia && options.returns == "dual";
  drive.returns = options.returns == "triple"      ? LivoxReturns::kTriple
                  : options.returns == "dual"      ? LivoxReturns::kDual
                  : options.returns == "strongest" ? LivoxReturns::kStrongest
                                                   : LivoxReturns::kFirst;
  drive.turn_rate_radps = options.turn_rate_degps * M_PI / 180.0;
  if (options.range_noise_m >= 0.0) {
    drive.range_noise_m = options.range_noise_m;
  }
  if (options.beam_bias_m >= 0.0) {
    drive.beam_bias_m = options.beam_bias_m;
  }
  if (options.perfect_imu) {
    drive.imu_errors = InertialErrors::none();
  }
  // There is no sky over these.
  drive.gnss_errors.covered =
      options.covered || drive.world == "indoor" || drive.world == "tunnel" || drive.world == "warehouse";
  if (!options.can.empty()) {
    drive.can = options.can == "xsens" ? imu::Protocol::kXsens : imu::Protocol::kAceinna;
  }
  check_live(options, drive);
  drive.driven = options.live || !options.drive_to.empty();
  if (drive.driven) {
    drive.vehicle = VehicleKind::kSkidSteer;
  }
  drive.mesh = options.mesh;
  if (asks_for_any(options.faults)) {
    if (drive.can) {
      throw cli::UsageError("--can: faults are those of packets and of imu.csv, and not of the bus");
    }
    drive.faults = faults_of(options.faults, drive.seed);
  }
  if (!options.waypoints.empty()) {
    drive.waypoints = read_waypoints(options.waypoints);
  }
  return drive;
}

}  // namespace slamd::simulate
