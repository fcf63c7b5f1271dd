#include "tools/sensors/starting_configuration.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "core/calibration/words.hpp"
#include "drivers/imu/protocol.hpp"
#include "drivers/transport/udp_receiver.hpp"
#include "tools/sensors/gravity.hpp"
#include "tools/sensors/remarks.hpp"

namespace slamd::sensors {

using calibration::in_tenths;
using calibration::rpy_in_words;
using configuration::LidarModel;
using transport::dotted;

namespace {

constexpr int kAskedRate_hz = 200;  // of a sensor that sends nothing until it is told

// Where hosts have them send, by the SDKs.
constexpr int kVelodynePort = 2368;
constexpr int kAviaPort = 56001;
constexpr int kMid360Port = 56301;

constexpr std::size_t kLongestCode = 16;
constexpr std::size_t kCommentColumn = 44;

/// Lines of TOML, each with a comment behind it.
class Lines {
 public:
  void table(const std::string& name) { text_ += "\n" + name + "\n"; }
  void blank() { text_ += "\n"; }
  void comment(const std::string& words) { text_ += "# " + words + "\n"; }
  void key(const std::string& assignment, const std::string& words) {
    text_ += assignment + std::string(assignment.size() < kCommentColumn ? kCommentColumn - assignment.size() : 1, ' ') + "# " + words + "\n";
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  }
  return result + '"';
}

std::string a_second(const Count& count, const char* what) {
  return std::to_string(count.last_second) + " " + what + " in the last second";
}

/// What slamd takes it for: by its own account, or, of a Livox whose packets alone are heard, by their form.
std::optional<LidarModel> model_of(const LidarSeen& lidar) {
  if (lidar.model || lidar.broadcasts.total > 0) {
    return lidar.model;
  }
  switch (lidar.protocol) {
    case LidarProtocol::kSdk1: return LidarModel::kLivoxAvia;
    case LidarProtocol::kSdk2: return LidarModel::kLivoxMid360;
    case LidarProtocol::kVelodyne: break;
  }
  return std::nullopt;
}

/// The LiDAR to begin with: one that this host reaches goes before one that it does not.
const LidarSeen* chosen_lidar(const Seen& seen) {
  const LidarSeen* chosen = nullptr;
  for (const LidarSeen& lidar : seen.lidars) {
    if (!model_of(lidar)) {
      continue;
    }
    const bool is_better = chosen == nullptr || (is_in_own_subnet(lidar.address, seen.interfaces) &&
                                                 !is_in_own_subnet(chosen->address, seen.interfaces));
    chosen = is_better ? &lidar : chosen;
  }
  return chosen;
}

bool is_code(const std::string& code) {
  return !code.empty() && code.size() <= kLongestCode &&
         std::all_of(code.begin(), code.end(), [](unsigned char c) { return std::isalnum(c) != 0; });
}

std::string time_in_words(const LidarSeen& lidar) {
  switch (lidar.time) {
    case TimeSource::kPtp: return "its stamps are PTP's: \"shared\" if this host follows the same master";
    case TimeSource::kGps: return "its stamps are GPS time: \"shared\" if this host follows it, too";
    case TimeSource::kPps: return "its stamps count from PPS, without a date";
    case TimeSource::kFreeRunning: return "its clock runs free";
    case TimeSource::kUnknown: break;
  }
  return lidar.pps == velodyne::PpsState::kLocked ? "it follows PPS; slamd estimates the rest" : "slamd estimates its clock";
}

/// What gravity says of a rotation that nobody has configured yet.
void propose_rotation(const InertialSeen& imu, const char* key, Lines& lines) {
  if (!imu.shows_gravity()) {
    lines.comment("Gravity was not to be judged: it moved, or its units are not SI.");
    return;
  }
  const Gravity gravity = compare_gravity(Eigen::Matrix3d::Identity(), imu.mean_force_mps2);
  if (gravity.angle_deg <= kGravityTolerance_deg) {
    lines.comment("Gravity was seen along " + up_axis(imu.mean_force_mps2) + " of it, " + in_tenths(gravity.angle_deg) + " degrees from there: as with this rotation.");
  } else {
    lines.comment("Gravity was seen along " + up_axis(imu.mean_force_mps2) + " of it: if the vehicle stood level, this is wrong, and " + key +
                  " should have rpy_deg = " + rpy_in_words(gravity.rpy_deg) + ", but for its yaw.");
  }
}

void write_livox(const LidarSeen& lidar, Lines& lines) {
  if (lidar.broadcasts.total == 0) {
    const int usual = lidar.protocol == LidarProtocol::kSdk1 ? kAviaPort : kMid360Port;
    lines.key("port = " + std::to_string(lidar.port == 0 ? usual : lidar.port), "it sends there already, set up by somebody else");
    return;
  }
  const std::string times = std::to_string(lidar.broadcasts.total) + " times in this time";
  lines.key("device.code = " + quoted(is_code(lidar.code) ? lidar.code : "any"),
            (lidar.protocol == LidarProtocol::kSdk1 ? "its broadcast code, heard " : "its serial number, heard ") + times + ": slamd sets and starts it");
}

void write_lidar(const LidarSeen& lidar, const Seen& seen, Lines& lines) {
  const LidarModel model = *model_of(lidar);
  lines.table("[[lidar]]");
  lines.key("model = " + quoted(configuration::name_of(model)), lidar.type + " at " + dotted(lidar.address));
  if (configuration::is_livox(model)) {
    write_livox(lidar, lines);
  } else {
    lines.key("source_address = " + quoted(dotted(lidar.address)), a_second(lidar.packets, "packets"));
    if (lidar.port != kVelodynePort) {
      lines.key("port = " + std::to_string(lidar.port), "where they arrive");
    }
  }
  if (!is_in_own_subnet(lidar.address, seen.interfaces)) {
    lines.comment("It is of another subnet than this host, which has " + subnets_in_words(seen.interfaces) + ".");
  }
  lines.key("clock = \"estimated\"", time_in_words(lidar));
  lines.key("T_base_lidar = { xyz_m = [0.0, 0.0, 0.0], rpy_deg = [0.0, 0.0, 0.0] }", "not to be heard: measure where it sits in base");
  if (lidar.imu) {
    propose_rotation(*lidar.imu, "T_base_lidar", lines);
  }
}

void write_place_of_imu(const InertialSeen& imu, Lines& lines) {
  lines.key("T_base_imu = { xyz_m = [0.0, 0.0, 0.0], rpy_deg = [0.0, 0.0, 0.0] }", "not to be heard: measure where it sits in base");
  propose_rotation(imu, "T_base_imu", lines);
}

bool is_inertial(const LineSeen& line) {
  return line.tongue == Tongue::kXsens || line.tongue == Tongue::kMip || line.tongue == Tongue::kCsv;
}

void write_serial_imu(const LineSeen& line, Lines& lines) {
  const imu::Protocol protocol = line.tongue == Tongue::kXsens ? imu::Protocol::kXsens
                                 : line.tongue == Tongue::kMip ? imu::Protocol::kMip
                                                               : imu::Protocol::kCsv;
  lines.table("[imu]");
  lines.key("source = \"serial\"", a_second(line.imu.samples, "samples"));
  lines.key("device = " + quoted(line.device), "where it was heard");
  lines.key("baud = " + std::to_string(line.baud), "found by listening");
  lines.key("protocol = " + quoted(imu::name_of(protocol)), name_of(line.tongue));
  if (line.imu.samples.total == 0 && protocol != imu::Protocol::kCsv) {
    lines.key("rate_hz = " + std::to_string(kAskedRate_hz), "it sends no samples as it is: slamd tells it to");
  }
  write_place_of_imu(line.imu, lines);
}

void write_rows(const RowsSeen& rows, Lines& lines) {
  lines.table("[imu]");
  lines.key("source = \"udp\"", a_second(rows.imu.samples, "samples") + " in rows of CSV from " + dotted(rows.address));
  lines.key("port = " + std::to_string(rows.port), "where they arrive");
  write_place_of_imu(rows.imu, lines);
}

bool speaks(const InertialSeen& imu) { return imu.samples.last_second >= 10; }

void write_can_imu(const BusSeen& bus, Lines& lines) {
  const bool is_xsens = speaks(bus.xsens);
  const InertialSeen& imu = is_xsens ? bus.xsens : bus.aceinna;
  lines.table("[imu]");
  lines.key("source = \"can\"", a_second(imu.samples, "samples"));
  lines.key("interface = " + quoted(bus.interface), a_second(bus.frames, "frames"));
  lines.key("protocol = " + quoted(imu::name_of(is_xsens ? imu::Protocol::kXsens : imu::Protocol::kAceinna)),
            is_xsens ? "an Xsens MTi-600, by its ids" : "an Aceinna, by its J1939 ids");
  if (!is_xsens) {
    lines.key("axis_map = \"y,x,z\"", "J1939's order; devices can be set otherwise");
  }
  write_place_of_imu(imu, lines);
}

/// The row source that speaks most. What looks like rows at a port of the LiDAR's is none: slamd would refuse it there.
const RowsSeen* chosen_rows(const LidarSeen& lidar, const Seen& seen) {
  const configuration::LidarConfiguration usual;
  const RowsSeen* chosen = nullptr;
  for (const RowsSeen& rows : seen.rows) {
    const bool is_of_lidar = rows.port == lidar.port || rows.port == usual.position_port || rows.port == usual.imu_port ||
                             rows.port == kVelodynePort || rows.port == kAviaPort || rows.port == kMid360Port;
    if (!is_of_lidar && (chosen == nullptr || rows.imu.samples.total > chosen->imu.samples.total)) {
      chosen = &rows;
    }
  }
  return chosen;
}

void write_imu(const LidarSeen& lidar, const Seen& seen, Lines& lines) {
  const RowsSeen* const rows = chosen_rows(lidar, seen);
  const auto line = std::find_if(seen.lines.begin(), seen.lines.end(), is_inertial);
  const auto bus = std::find_if(seen.buses.begin(), seen.buses.end(),
                                [](const BusSeen& candidate) { return speaks(candidate.xsens) || speaks(candidate.aceinna); });
  if (line != seen.lines.end()) {
    write_serial_imu(*line, lines);
  } else if (bus != seen.buses.end()) {
    write_can_imu(*bus, lines);
  } else if (rows != nullptr) {
    write_rows(*rows, lines);
  } else if (configuration::is_livox(*model_of(lidar))) {
    lines.table("[imu]");
    lines.key("source = \"livox\"", lidar.imu ? a_second(lidar.imu->samples, "samples") + " of its own" : std::string("its own; it sends once it is started"));
  } else {
    lines.blank();
    lines.comment("No inertial sensor was heard: without an [imu] table slamd maps by the LiDAR alone.");
  }
}

void write_gnss(const LidarSeen& lidar, const Seen& seen, Lines& lines) {
  const auto line = std::find_if(seen.lines.begin(), seen.lines.end(), [](const LineSeen& candidate) { return candidate.tongue == Tongue::kGnss; });
  if (line != seen.lines.end()) {
    lines.table("[gnss]");
    lines.key("source = \"serial\"", a_second(line->gnss.good, "good fixes") + ", " + std::to_string(line->gnss.satellites) + " satellites");
    lines.key("device = " + quoted(line->device), "where it was heard");
    lines.key("baud = " + std::to_string(line->baud), "found by listening");
  } else if (lidar.protocol == LidarProtocol::kVelodyne && !lidar.sentence.empty()) {
    lines.table("[gnss]");
    lines.key("source = \"velodyne\"", "its position packets have sentences of a receiver");
  } else {
    return;
  }
  lines.key("T_base_antenna = { xyz_m = [0.0, 0.0, 0.0] }", "not to be heard: measure where the antenna sits in base");
}

/// What the buses carry beside inertial samples: wheels are there by a vehicle's own table, which nobody can hear.
void write_buses(const Seen& seen, Lines& lines) {
  constexpr std::size_t kMostShown = 16;
  for (const BusSeen& bus : seen.buses) {
    if (bus.ids.empty()) {
      continue;
    }
    lines.blank();
    lines.comment(printable(bus.interface) + " carries these ids; where wheel speeds are among them, only the vehicle's DBC file tells (docs/configuration.md, [wheel]):");
    for (std::size_t i = 0; i < std::min(bus.ids.size(), kMostShown); ++i) {
      char text[96];
      std::snprintf(text, sizeof text, "  id 0x%X%s, %u bytes, %llu in the last second", bus.ids[i].id,
                    bus.ids[i].is_extended ? " (extended)" : "", static_cast<unsigned>(bus.ids[i].size),
                    static_cast<unsigned long long>(bus.ids[i].frames.last_second));
      lines.comment(text);
    }
    if (bus.ids.size() > kMostShown) {
      lines.comment("  and " + std::to_string(bus.ids.size() - kMostShown) + " more: slamd-sensors shows them all");
    }
  }
}

}  // namespace

std::string starting_configuration(const Seen& seen, const std::string& when) {
  const LidarSeen* const lidar = chosen_lidar(seen);
  if (lidar == nullptr) {
    throw std::runtime_error("no LiDAR was found that slamd reads: there is no configuration to begin with");
  }
  Lines lines;
  lines.comment("Written by slamd-sensors, " + when + ", of what it had seen in " + in_tenths(seen.listened_s) + " s.");
  lines.comment("slamd --check --config FILE tells what is still missing; docs/configuration.md has every key.");
  write_lidar(*lidar, seen, lines);
  write_imu(*lidar, seen, lines);
  write_gnss(*lidar, seen, lines);
  write_buses(seen, lines);
  for (const LidarSeen& other : seen.lidars) {
    if (&other != lidar) {
      lines.blank();
      lines.comment("Also seen: " + name_of(other) + "; this release takes exactly one [[lidar]].");
    }
  }
  return lines.text();
}

void write_file(const std::filesystem::path& file, const std::string& text, bool force) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (force ? O_TRUNC : O_EXCL), 0644);
  if (fd < 0) {
    throw std::runtime_error(file.string() + (errno == EEXIST ? ": is there already; --force replaces it"
                                                              : ": cannot be written: " + std::generic_category().message(errno)));
  }
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (::close(fd) != 0 || !written) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
}

}  // namespace slamd::sensors
