#include "daemon/configuration/key_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "daemon/configuration/can_keys.hpp"
#include "daemon/configuration/key_makers.hpp"

namespace slamd::configuration {

using namespace keys;

namespace {

Key self_filter_boxes() {
  Key key;
  key.path = "self_filter.boxes";
  key.kind = Key::Kind::kBoxes;
  key.help = "Boxes in base that hold the robot's own body: points inside are dropped.";
  key.set = [](Configuration& c, const Value& v) {
    auto& boxes = c.odometry.preprocess.self_filter.boxes_base;
    boxes.clear();
    for (const scan::Box& box : std::get<std::vector<scan::Box>>(v)) {
      boxes.push_back(box);
    }
  };
  key.get = [](const Configuration& c) {
    const auto& boxes = c.odometry.preprocess.self_filter.boxes_base;
    return Value(std::vector<scan::Box>(boxes.begin(), boxes.end()));
  };
  return key;
}

#define SLAMD_FIELD(member) [](Configuration& c) -> auto& { return c.member; }

void add_device_keys(std::vector<Key>& keys) {
  using C = DeviceCoordinates;
  using R = DeviceReturns;
  keys.push_back(text("lidar.device.code", "Live, Livox: the device that slamd finds, sets and starts by itself: an Avia's broadcast code, a Mid-360's serial number, or \"any\"; empty: somebody else does.", SLAMD_FIELD(lidar.device.code)));
  keys.push_back(choice<C>("lidar.device.coordinates", {{"cartesian", C::kCartesian}, {"spherical", C::kSpherical}}, "Of the points that the device is told to send.", SLAMD_FIELD(lidar.device.coordinates)));
  keys.push_back(choice<R>("lidar.device.returns", {{"unchanged", R::kUnchanged}, {"first", R::kFirst}, {"strongest", R::kStrongest}, {"dual", R::kDual}, {"triple", R::kTriple}}, "Echoes that an Avia is told to send.", SLAMD_FIELD(lidar.device.returns)));
  keys.push_back(boolean("lidar.device.take_over", "Take a Mid-360 that is set to send to another host.", SLAMD_FIELD(lidar.device.take_over)));
  keys.push_back(boolean("lidar.device.set_utc", "Tell an Avia with PPS each second's UTC, from the receiver at gnss.source = \"serial\".", SLAMD_FIELD(lidar.device.set_utc)));
  keys.push_back(number("lidar.device.command_port", 0, 65535, "Of this host, for commands to the device; 0: the SDK's (55501, 56101).", SLAMD_FIELD(lidar.device.command_port)));
  keys.push_back(number("lidar.device.state_port", 1, 65535, "Of this host, for a Mid-360's state.", SLAMD_FIELD(lidar.device.state_port)));
}

void add_sensor_keys(std::vector<Key>& keys) {
  const std::vector<std::pair<std::string, SensorClock>> clocks{{"estimated", SensorClock::kEstimated},
                                                                {"shared", SensorClock::kShared}};
  std::vector<std::pair<std::string, imu::Protocol>> protocols;
  for (const imu::Protocol protocol : {imu::Protocol::kCsv, imu::Protocol::kXsens, imu::Protocol::kMip, imu::Protocol::kAceinna}) {
    protocols.emplace_back(name_of(protocol), protocol);
  }
  std::vector<std::pair<std::string, LidarModel>> models;
  for (const LidarModel model : {LidarModel::kVlp16, LidarModel::kVlp16HiRes, LidarModel::kVlp32c, LidarModel::kHdl32e,
                                 LidarModel::kLivoxAvia, LidarModel::kLivoxMid360, LidarModel::kPoints}) {
    models.emplace_back(name_of(model), model);
  }
  keys.push_back(choice("lidar.model", models, "What sends the packets; points: a folder of clouds.", SLAMD_FIELD(lidar.model)));
  keys.push_back(text("lidar.source", "File or folder of the recording; empty: its only pcap.", SLAMD_FIELD(lidar.source)));
  keys.push_back(number("lidar.port", 0, 65535, "UDP destination port of the data; 0: the model's own.", SLAMD_FIELD(lidar.port)));
  keys.push_back(number("lidar.position_port", 0, 65535, "UDP destination port of Velodyne position packets.", SLAMD_FIELD(lidar.position_port)));
  keys.push_back(number("lidar.imu_port", 1, 65535, "UDP destination port of a Mid-360's own inertial samples.", SLAMD_FIELD(lidar.imu_port)));
  keys.push_back(text("lidar.bind_address", "Live: this host's address at which the packets arrive; 0.0.0.0: all of them, broadcasts included.", SLAMD_FIELD(lidar.bind_address)));
  keys.push_back(text("lidar.source_address", "Live: the sensor's own address; empty: the first that sends good packets.", SLAMD_FIELD(lidar.source_address)));
  add_transform(keys, "lidar.T_base_lidar", "The LiDAR's place in base.",
                [](Configuration& c) -> geometry::Se3& { return c.lidar.T_base_lidar; },
                [](const Configuration& c) { return std::optional<geometry::Se3>(c.lidar.T_base_lidar); });
  keys.push_back(number("lidar.min_range_m", 0.0, 100.0, "Nearer returns are dropped.", SLAMD_FIELD(odometry.preprocess.self_filter.min_range_m)));
  keys.push_back(number("lidar.max_range_m", 1.0, 1000.0, "Farther returns are dropped.", SLAMD_FIELD(odometry.preprocess.self_filter.max_range_m)));
  keys.push_back(number("lidar.cut_azimuth_deg", 0.0, 360.0, "Where a spinning sensor's scan is cut.", SLAMD_FIELD(lidar.cut_azimuth_deg)));
  keys.push_back(number("lidar.scan_period_ms", 20.0, 500.0, "Length of a Livox scan, in device time.", SLAMD_FIELD(lidar.scan_period)));
  keys.push_back(choice("lidar.clock", clocks, "shared: stamps are on the host's time base (PTP, GPS).", SLAMD_FIELD(lidar.clock)));
  keys.push_back(boolean("lidar.vertical_parallax", "Correct the lasers' vertical offsets (VLP-16).", SLAMD_FIELD(lidar.vertical_parallax)));
  keys.push_back(boolean("lidar.points_have_time", "false: a points folder is compensated already.", SLAMD_FIELD(lidar.points_have_time)));
  keys.push_back(number("lidar.scans_per_second", 0.5, 100.0, "Rate of a points folder without stamps.", SLAMD_FIELD(lidar.scans_per_second)));
  add_device_keys(keys);
  keys.push_back(boolean("imu.enabled", "true as soon as the table is there.", SLAMD_FIELD(imu.enabled)));
  keys.push_back(text("imu.source", "A CSV file or a candump log (.log) of the recording, or \"livox\" for the built-in sensor; live also \"udp\" (CSV rows), \"serial\" or \"can\".", SLAMD_FIELD(imu.source)));
  keys.push_back(number("imu.port", 1, 65535, "Live, \"udp\": destination port of the rows.", SLAMD_FIELD(imu.port)));
  keys.push_back(text("imu.device", "Live, \"serial\": the terminal, such as /dev/ttyUSB0, or better a link below /dev/serial/by-id.", SLAMD_FIELD(imu.device)));
  keys.push_back(number("imu.baud", 0, 4000000, "Live, \"serial\": its rate, one of the standard ones; 0: found by listening.", SLAMD_FIELD(imu.baud)));
  keys.push_back(choice("imu.protocol", protocols, "\"serial\": CSV rows, Xsens MTData2 or MicroStrain MIP; \"can\": Xsens MTi-600 or Aceinna (J1939).", SLAMD_FIELD(imu.protocol)));
  keys.push_back(number("imu.rate_hz", 0, 2000, "Live, \"serial\", \"xsens\" and \"mip\": samples a second that the sensor is told to send; 0: it is left as it is.", SLAMD_FIELD(imu.rate_hz)));
  add_imu_can_keys(keys);
  add_transform(keys, "imu.T_base_imu", "The inertial sensor's place in base; a Livox's own follows from T_base_lidar.",
                [](Configuration& c) -> geometry::Se3& {
                  if (!c.imu.T_base_imu) {
                    c.imu.T_base_imu.emplace();
                  }
                  return *c.imu.T_base_imu;
                },
                [](const Configuration& c) { return c.imu.T_base_imu; });
  keys.push_back(choice("imu.clock", clocks, "As lidar.clock; a CSV file is on the time base already.", SLAMD_FIELD(imu.clock)));
  keys.push_back(number("imu.offset_ms", -500.0, 500.0, "By which inertial stamps are late against the LiDAR's: taken off. A drive shows it (report.json, health).", SLAMD_FIELD(odometry.imu_offset)));
  keys.push_back(number("imu.gyro_noise_radps_sqrthz", 1e-6, 1.0, "Density of the gyroscope's noise.", SLAMD_FIELD(odometry.imu_noise.gyro_noise_radps_sqrthz)));
  keys.push_back(number("imu.gyro_scale_error", 0.0, 0.1, "Scale error and misalignment of the gyroscope, as a share of the turn rate.", SLAMD_FIELD(odometry.imu_noise.gyro_scale_error)));
  keys.push_back(number("imu.accel_noise_mps2_sqrthz", 1e-5, 10.0, "Density of the accelerometer's noise, with vibration.", SLAMD_FIELD(odometry.imu_noise.accel_noise_mps2_sqrthz)));
  keys.push_back(number("imu.gyro_bias_walk_radps2_sqrthz", 1e-8, 0.1, "Walk of the gyroscope's bias.", SLAMD_FIELD(odometry.imu_noise.gyro_bias_walk_radps2_sqrthz)));
  keys.push_back(number("imu.accel_bias_walk_mps3_sqrthz", 1e-7, 1.0, "Walk of the accelerometer's bias.", SLAMD_FIELD(odometry.imu_noise.accel_bias_walk_mps3_sqrthz)));
  keys.push_back(boolean("wheel.use", "Use wheel odometry where there is a source.", SLAMD_FIELD(wheel.use)));
  keys.push_back(text("wheel.source", "A CSV file or a candump log (.log) of the recording; live: \"can\"; empty: no wheels.", SLAMD_FIELD(wheel.source)));
  add_wheel_can_keys(keys);
  keys.push_back(boolean("gnss.use", "Use positions in the graph (a later release).", SLAMD_FIELD(gnss.use)));
  keys.push_back(text("gnss.source", "A file of the recording (CSV, or a receiver's NMEA and UBX), or \"velodyne\" for the sentences of its position packets; live also \"serial\", but no file.", SLAMD_FIELD(gnss.source)));
  keys.push_back(text("gnss.device", "Live, \"serial\": the terminal, such as /dev/ttyACM0, or better a link below /dev/serial/by-id.", SLAMD_FIELD(gnss.device)));
  keys.push_back(number("gnss.baud", 0, 4000000, "Live, \"serial\": its rate, one of the standard ones; 0: found by listening.", SLAMD_FIELD(gnss.baud)));
  add_transform(keys, "gnss.T_base_antenna", "The antenna's place in base.",
                [](Configuration& c) -> geometry::Se3& { return c.gnss.T_base_antenna; },
                [](const Configuration& c) { return std::optional<geometry::Se3>(c.gnss.T_base_antenna); });
  keys.push_back(self_filter_boxes());
}

void add_odometry_keys(std::vector<Key>& keys) {
  using odometry::Environment;
  using odometry::Filter;
  keys.push_back(choice<Filter>("odometry.filter", {{"psf", Filter::kPsf}, {"iekf", Filter::kIekf}}, "Particle swarm filter, or the EKF alone.", SLAMD_FIELD(odometry.filter)));
  keys.push_back(choice<Environment>("odometry.environment", {{"auto", Environment::kAuto}, {"indoor", Environment::kIndoor}, {"outdoor", Environment::kOutdoor}}, "Cell sizes and the swarm's little square.", SLAMD_FIELD(odometry.environment)));
  keys.push_back(number("odometry.seed", 0, 1e9, "Of the swarm; the same seed gives the same trajectory.", SLAMD_FIELD(odometry.seed)));
  keys.push_back(number("odometry.max_planar", 100, 20000, "Planar features a scan.", SLAMD_FIELD(odometry.preprocess.max_planar)));
  keys.push_back(number("odometry.max_edge", 0, 5000, "Edge features a scan.", SLAMD_FIELD(odometry.preprocess.max_edge)));
  keys.push_back(number("odometry.max_points", 1000, 1e6, "Returns a scan; more are counted and dropped.", SLAMD_FIELD(odometry.preprocess.max_points)));
  keys.push_back(number("odometry.feature_spacing_outdoor_m", 0.05, 5.0, "Features: one in a cube of this side.", SLAMD_FIELD(odometry.preprocess.feature_spacing_outdoor_m)));
  keys.push_back(number("odometry.feature_spacing_indoor_m", 0.05, 5.0, "The same indoors.", SLAMD_FIELD(odometry.preprocess.feature_spacing_indoor_m)));
  keys.push_back(number("odometry.planar_std_m", 0.005, 1.0, "Measurement noise of a point against its plane.", SLAMD_FIELD(odometry.update.association.planar_std_m)));
  keys.push_back(number("odometry.edge_std_m", 0.005, 2.0, "Measurement noise of a point against its line.", SLAMD_FIELD(odometry.update.association.edge_std_m)));
  keys.push_back(number("odometry.kernel_m", 0.01, 5.0, "Scale of the Cauchy kernel.", SLAMD_FIELD(odometry.update.kernel_m)));
  keys.push_back(number("odometry.information_share", 0.001, 1.0, "Part of the points that counts as independent.", SLAMD_FIELD(odometry.update.information_share)));
  keys.push_back(number("odometry.max_iterations", 1, 50, "Of the iterated EKF.", SLAMD_FIELD(odometry.update.max_iterations)));
  keys.push_back(number("odometry.little_particles", 2, 256, "Particles of the little swarm.", SLAMD_FIELD(odometry.psf.little_particles)));
  keys.push_back(number("odometry.recovery_particles", 2, 256, "Particles of the recovery swarm at first.", SLAMD_FIELD(odometry.psf.recovery_particles)));
  keys.push_back(number("odometry.recovery_m", 0.1, 2.0, "Half side of the recovery box.", SLAMD_FIELD(odometry.psf.recovery_m)));
  keys.push_back(number("odometry.recovery_deg", 1.0, 20.0, "Half side of the recovery box.", SLAMD_FIELD(odometry.psf.recovery_rad), kDegree));
  keys.push_back(number("odometry.trigger_drop", 0.01, 4.5, "Fall of the mean log-likelihood that starts a recovery.", SLAMD_FIELD(odometry.psf.trigger_drop)));
  keys.push_back(number("odometry.static_window_ms", 200.0, 60000.0, "Rest at the start after which odom is levelled.", SLAMD_FIELD(odometry.start_up.static_window)));
  keys.push_back(number("map.window_m", 10.0, 10000.0, "Path after which an untouched cell is forgotten.", SLAMD_FIELD(odometry.map.window_m)));
  keys.push_back(number("map.max_cells", 1000, 1e6, "Fine cells of 1 m; the oldest are recycled.", SLAMD_FIELD(odometry.map.max_cells)));
  keys.push_back(number("map.max_surface_cells", 1000, 4e6, "Coarse cells; the oldest are recycled.", SLAMD_FIELD(odometry.map.max_surface_cells)));
  keys.push_back(boolean("mapping.use", "Keep keyframes, look for loops and correct the map by them.", SLAMD_FIELD(mapping.use)));
  keys.push_back(boolean("mapping.loop_net", "Let Loop-Net propose loops by what places look like, where the map no longer knows where they lie.", SLAMD_FIELD(mapping.loop_net)));
  keys.push_back(number("mapping.keyframes", 100, 100'000, "Keyframes at most (45 kB each); then the most redundant one is given up for each new one.", SLAMD_FIELD(mapping.keyframes)));
  keys.push_back(number("mapping.loops", 16, 100'000, "Loops in the graph at most.", SLAMD_FIELD(mapping.loops)));
  keys.push_back(number("mapping.cloud_points", 500, 20'000, "Points of a keyframe's cloud (6 bytes each).", SLAMD_FIELD(mapping.cloud_points)));
  keys.push_back(number("mapping.spacing_indoor_m", 0.2, 20.0, "Of keyframes where the map has none like it.", SLAMD_FIELD(mapping.spacing_indoor_m)));
  keys.push_back(number("mapping.spacing_outdoor_m", 0.2, 50.0, "The same outdoors.", SLAMD_FIELD(mapping.spacing_outdoor_m)));
  keys.push_back(text("mapping.session_directory", "Live: where the map is written while it grows, a folder each time, for slamd-map; empty: nowhere.", SLAMD_FIELD(mapping.session_directory)));
  keys.push_back(number("mapping.session_quota_mb", 10, 10'000'000, "Of all sessions in that folder: the oldest go first, then the oldest part of the one that is written.", SLAMD_FIELD(mapping.session_quota_mb)));
  keys.push_back(number("mapping.sessions", 1, 10'000, "Sessions in that folder at most: the oldest go.", SLAMD_FIELD(mapping.sessions)));
  keys.push_back(number("mapping.view_deg", 5.0, 180.0, "Between the headings of two keyframes that are compared: less for a LiDAR that does not look around.", SLAMD_FIELD(mapping.view_deg)));
  keys.push_back(number("output.map_spacing_m", 0.02, 5.0, "Points of map.ply: one in a cube of this side.", SLAMD_FIELD(output.map_spacing_m)));
  keys.push_back(live(text("output.save_directory", "Live: where the command save writes, a folder each time; empty: it is refused.", SLAMD_FIELD(output.save_directory))));
  keys.push_back(live(boolean("realtime.fifo", "Live: threads under SCHED_FIFO where it is permitted.", SLAMD_FIELD(realtime.fifo))));
  keys.push_back(live(number("realtime.priority", 1, 90, "Live: SCHED_FIFO priority of the odometry; the threads before it lie up to three higher.", SLAMD_FIELD(realtime.priority))));
  keys.push_back(boolean("realtime.lock_memory", "Live: keep all memory in RAM where it is permitted.", SLAMD_FIELD(realtime.lock_memory)));
  keys.push_back(text("lcm.url", "Where the messages go. ttl=0: not beyond this computer.", SLAMD_FIELD(lcm.url)));
  keys.push_back(name("lcm.prefix", "Of the channels' names; two daemons on one network need two.", SLAMD_FIELD(lcm.prefix)));
  keys.push_back(number("lcm.scan_points", 0, 100000, "Points of a scan that are sent; 0: no scans.", SLAMD_FIELD(lcm.scan_points)));
  keys.push_back(live(number("log.repeat_period_ms", 0.0, 3'600'000.0, "Live: messages of one cause are written once, and their number after this time; 0: all are written.", SLAMD_FIELD(log.repeat_period))));
}

#undef SLAMD_FIELD

/// The shortest decimal number that reads back to the same double.
std::string shortest(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// As TOML writes a float.
std::string shortest_float(double value) {
  const std::string line = shortest(value);
  return line.find_first_of(".e") == std::string::npos ? line + ".0" : line;
}

/// As TOML writes a basic string.
std::string toml_string(const std::string& text) {
  std::string line = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      line += '\\';
      line += c;
    } else if (code < 0x20 || code == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned>(code));
      line += escape;
    } else {
      line += c;
    }
  }
  return line + '"';
}

std::string print_value(const Key& key, const Value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const auto* name = std::get_if<std::string>(&value)) {
    return toml_string(*name);
  }
  if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
    std::string line = "[";
    for (const double v : *numbers) {
      line += (line.size() > 1 ? ", " : "") + shortest_float(v);
    }
    return line + "]";
  }
  if (const auto* boxes = std::get_if<std::vector<scan::Box>>(&value)) {
    std::string line = "[";
    const auto triple = [](const float (&v)[3]) {
      return "[" + shortest_float(to_number(v[0])) + ", " + shortest_float(to_number(v[1])) + ", " +
             shortest_float(to_number(v[2])) + "]";
    };
    for (const scan::Box& box : *boxes) {
      line += (line.size() > 1 ? ", " : "") + std::string("{ min_m = ") + triple(box.min_m) + ", max_m = " +
              triple(box.max_m) + " }";
    }
    return line + "]";
  }
  const double v = std::get<double>(value);
  if (key.kind == Key::Kind::kInteger) {
    return std::to_string(static_cast<long long>(v));
  }
  return shortest_float(v);
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace

std::string Key::allowed() const {
  switch (kind) {
    case Kind::kBoolean: return "true or false";
    case Kind::kText: return "a text in quotes";
    case Kind::kName: return "1 to 40 letters, digits, '_' or '-', in quotes";
    case Kind::kInteger:
      return "a whole number from " + std::to_string(static_cast<long long>(min)) + " to " +
             std::to_string(static_cast<long long>(max));
    case Kind::kNumber: return "a number from " + shortest(min) + " to " + shortest(max);
    case Kind::kVector3: return "three numbers from " + shortest(min) + " to " + shortest(max);
    case Kind::kBoxes:
      return "up to " + std::to_string(scan::SelfFilter::kMaxBoxes) + " of { min_m = [x, y, z], max_m = [x, y, z] }";
    case Kind::kChoice: break;
  }
  std::string line = "one of";
  for (const std::string& name : choices) {
    line += (line == "one of" ? " \"" : ", \"") + name + '"';
  }
  return line;
}

const std::vector<Key>& all_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> list;
    add_sensor_keys(list);
    add_odometry_keys(list);
    return list;
  }();
  return keys;
}

const Key* find_key(const std::string& path) {
  for (const Key& key : all_keys()) {
    if (key.path == path) {
      return &key;
    }
  }
  return nullptr;
}

std::string nearest_path(const std::string& path) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(3, path.size() / 4);
  for (const Key& key : all_keys()) {
    const std::size_t distance = edit_distance(path, key.path);
    if (distance < best_distance) {
      best_distance = distance;
      best = key.path;
    }
  }
  return best;
}

std::vector<std::string> names_below(const std::string& table) {
  std::vector<std::string> names;
  for (const Key& key : all_keys()) {
    if (key.path.rfind(table + ".", 0) == 0) {
      const std::string rest = key.path.substr(table.size() + 1);
      const std::string name = rest.substr(0, rest.find('.'));
      if (std::find(names.begin(), names.end(), name) == names.end()) {
        names.push_back(name);
      }
    }
  }
  return names;
}

std::string print_value(const Key& key, const Configuration& configuration) {
  const Value value = key.get(configuration);
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  return key.optional && numbers != nullptr && numbers->empty() ? "unset" : print_value(key, value);
}

std::string print_configuration(const Configuration& configuration) {
  std::string result;
  std::string table;
  for (const Key& key : all_keys()) {
    const Value value = key.get(configuration);
    const auto* numbers = std::get_if<std::vector<double>>(&value);
    if (key.optional && numbers != nullptr && numbers->empty()) {
      continue;
    }
    const std::size_t dot = key.path.find('.');
    const std::string own_table = key.path.substr(0, dot);
    if (own_table != table) {
      table = own_table;
      result += (result.empty() ? "" : "\n") + (table == "lidar" ? "[[lidar]]" : "[" + table + "]") + "\n";
    }
    result += key.path.substr(dot + 1) + " = " + print_value(key, value) + "\n";
  }
  return result;
}

std::string print_reference() {
  std::string result = "| key | default | allowed | meaning |\n|---|---|---|---|\n";
  const Configuration defaults{};
  for (const Key& key : all_keys()) {
    const Value value = key.get(defaults);
    const auto* numbers = std::get_if<std::vector<double>>(&value);
    const bool unset = key.optional && numbers != nullptr && numbers->empty();
    result += "| `" + key.path + "` | " + (unset ? std::string("–") : "`" + print_value(key, value) + "`") + " | " +
              key.allowed() + " | " + key.help + " |\n";
  }
  return result;
}

}  // namespace slamd::configuration
