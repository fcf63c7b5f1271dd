#include "tools/sensors/remarks.hpp"

#include <bit>
#include <cmath>
#include <cstdio>

#include "core/calibration/words.hpp"
#include "drivers/livox/sdk1_host.hpp"
#include "drivers/livox/status_code.hpp"
#include "drivers/transport/udp_receiver.hpp"
#include "tools/sensors/gravity.hpp"

namespace slamd::sensors {

using calibration::in_tenths;
using calibration::rpy_in_words;
using configuration::Configuration;
using transport::dotted;

namespace {

/// A Livox announces itself once a second.
constexpr double kSilent_s = 3.5;

using Remarks = std::vector<Remark>;

LidarProtocol protocol_of(configuration::LidarModel model) {
  switch (model) {
    case configuration::LidarModel::kLivoxAvia: return LidarProtocol::kSdk1;
    case configuration::LidarModel::kLivoxMid360: return LidarProtocol::kSdk2;
    default: return LidarProtocol::kVelodyne;
  }
}

/// Who else on this computer hears the broadcasts of SDK1 devices, as each of their hosts does.
std::string other_sdk1_host(const Seen& seen) {
  for (const PortSeen& port : seen.ports) {
    if (port.port == livox::Sdk1Host::kBroadcastPort) {
      return port.beside.empty() ? port.owner : port.beside;
    }
  }
  return "";
}

void judge_port(const PortSeen& port, Remarks& remarks) {
  const std::string name = "UDP port " + std::to_string(port.port);
  if (!port.owner.empty()) {
    remarks.push_back({name, "is taken by " + port.owner + ": " + port.purpose + " are not heard here"});
  }
  if (port.strange.total > 0) {
    remarks.push_back({name, std::to_string(port.strange.total) + " datagrams are no sensor's that is known, the last one of " +
                                 dotted(port.stranger)});
  }
  if (port.lost > 0) {
    remarks.push_back({name, std::to_string(port.lost) + " datagrams were lost in the kernel"});
  }
}

/// One for all ports: they ask for the same.
void judge_buffers(const Seen& seen, Remarks& remarks) {
  for (const PortSeen& port : seen.ports) {
    if (!port.buffer.empty()) {
      const std::size_t colon = port.buffer.find(": ");
      remarks.push_back({"receive buffers", colon == std::string::npos ? port.buffer : port.buffer.substr(colon + 2)});
      return;
    }
  }
}

void judge_subnet(const LidarSeen& lidar, const Seen& seen, Remarks& remarks) {
  if (!is_in_own_subnet(lidar.address, seen.interfaces)) {
    remarks.push_back({name_of(lidar), "is of another subnet than this host, which has " + subnets_in_words(seen.interfaces) +
                                           ": give the interface an address of the sensor's subnet, or the sensor another one"});
  }
}

void judge_holder(const LidarSeen& lidar, const Seen& seen, Remarks& remarks) {
  const bool sends_here = lidar.packets.last_second > 0;
  const bool fell_silent = lidar.broadcasts.total > 0 && lidar.silent_s > kSilent_s;
  if (lidar.protocol == LidarProtocol::kSdk1 && fell_silent && !sends_here) {
    const std::string owner = other_sdk1_host(seen);
    remarks.push_back({name_of(lidar), "looks for no host any more: " + (owner.empty() ? "another host owns it, or it is off" :
                                                                          "it belongs to " + owner + " on this computer, to another host, or is off")});
  }
  if (lidar.protocol != LidarProtocol::kSdk2) {
    return;
  }
  if (fell_silent && !sends_here) {
    remarks.push_back({name_of(lidar), "does not answer any more: it is off, or its cable is out"});
  }
  if (lidar.sends_to.value_or(0) != 0) {
    bool is_own = false;
    for (const transport::Interface& interface : seen.interfaces) {
      is_own = is_own || interface.address == *lidar.sends_to;
    }
    if (!is_own) {
      remarks.push_back({name_of(lidar), "is set to send to another host, " + dotted(*lidar.sends_to) +
                                             ": slamd takes it from that one, unless lidar.device.take_over is false"});
    }
  }
}

void judge_avia(const AviaSeen& avia, Remarks& remarks) {
  const std::string name = "Livox SDK1 device at " + dotted(avia.address);
  switch (avia.answer) {
    case AviaAnswer::kNotAsked: remarks.push_back({name, "is not asked: " + avia.hindrance}); break;
    case AviaAnswer::kNone: remarks.push_back({name, "does not answer: it is off, or not there"}); break;
    case AviaAnswer::kRefusal: remarks.push_back({name, "refuses this host: another one owns it"}); break;
    case AviaAnswer::kConsent: remarks.push_back({name, "had no host; it was let go again"}); break;
  }
}

void judge_time(const LidarSeen& lidar, Remarks& remarks) {
  const std::string name = name_of(lidar);
  if (lidar.protocol == LidarProtocol::kVelodyne) {
    if (lidar.pps == velodyne::PpsState::kNone) {
      remarks.push_back({name, "hears no PPS: its clock runs free, and slamd estimates it"});
    } else if (lidar.pps == velodyne::PpsState::kError) {
      remarks.push_back({name, "says that its PPS is in error"});
    } else if (lidar.pps == velodyne::PpsState::kSynchronising) {
      remarks.push_back({name, "hears PPS, but does not follow it yet"});
    } else if (!lidar.pps && lidar.packets.total > 0) {
      remarks.push_back({name, "sends no position packets to UDP port 8308, which would tell of PPS"});
    }
    if (lidar.pps == velodyne::PpsState::kLocked && lidar.sentence.empty()) {
      remarks.push_back({name, "hears PPS, but no sentence that says which second it is"});
    }
    return;
  }
  if (lidar.time == TimeSource::kFreeRunning) {
    const bool hears_pps = lidar.status && lidar.status->pps_present;
    remarks.push_back({name, hears_pps ? "hears PPS, but follows it not: lidar.device.set_utc tells it the second"
                                       : "follows no clock, neither PTP nor PPS: its clock runs free, and slamd estimates it"});
  }
}

void judge_health(const LidarSeen& lidar, Remarks& remarks) {
  if (lidar.status) {
    for (const std::string_view concern : livox::concerns_of(*lidar.status)) {
      remarks.push_back({name_of(lidar), "says: " + std::string(concern)});
    }
  }
  if (lidar.health_code.value_or(0) != 0) {
    remarks.push_back({name_of(lidar), "reports health code " + std::to_string(*lidar.health_code)});
  }
  if (lidar.refused > 0) {
    remarks.push_back({name_of(lidar), std::to_string(lidar.refused) + " datagrams of its address are damaged, or not its own"});
  }
}

void judge_lidar(const LidarSeen& lidar, const Seen& seen, Remarks& remarks) {
  judge_subnet(lidar, seen, remarks);
  judge_holder(lidar, seen, remarks);
  if (!lidar.model && lidar.protocol != LidarProtocol::kVelodyne && lidar.broadcasts.total > 0) {
    remarks.push_back({name_of(lidar), "is of a type that this release does not read"});
  }
  judge_time(lidar, remarks);
  judge_health(lidar, remarks);
}

/// What is wrong with samples, whoever sends them. R_base_imu: where it is configured to sit, and the key that says so.
void judge_inertial(const std::string& name, const InertialSeen& imu, const Eigen::Matrix3d* R_base_imu, const char* key,
                    Remarks& remarks) {
  if (imu.samples.total == 0) {
    return;
  }
  if (const std::string units = imu::in_words(imu.units); !units.empty()) {
    remarks.push_back({name, units});
  }
  if (imu.missing > 0) {
    remarks.push_back({name, std::to_string(imu.missing) + " samples are missing, by its own count"});
  }
  if (imu.clipped > 0) {
    remarks.push_back({name, std::to_string(imu.clipped) + " samples are at its limits"});
  }
  if (R_base_imu == nullptr || !imu.shows_gravity()) {
    return;
  }
  const Gravity gravity = compare_gravity(*R_base_imu, imu.mean_force_mps2);
  if (gravity.angle_deg > kGravityTolerance_deg) {
    remarks.push_back({name, "gravity is " + in_tenths(gravity.angle_deg) + " degrees from where " + key + " has it, if the vehicle stands level: " +
                                 up_axis(imu.mean_force_mps2) + " of imu is up; rpy_deg = " + rpy_in_words(gravity.rpy_deg) +
                                 " would have it there"});
  }
}

void judge_gnss(const std::string& name, const GnssSeen& gnss, Remarks& remarks) {
  if (gnss.fixes.total == 0) {
    remarks.push_back({name, "says neither RMC nor GGA nor UBX-NAV-PVT: there is no fix to be had of it"});
  } else if (gnss.good.last_second == 0 && !gnss.lacks.empty()) {
    remarks.push_back({name, "has no good fix: " + gnss.lacks + ", " + std::to_string(gnss.satellites) + " satellites"});
  }
}

void judge_line(const LineSeen& line, const Seen& seen, const Eigen::Matrix3d* R_base_imu, Remarks& remarks) {
  if (!line.trouble.empty()) {
    remarks.push_back({line.device, line.trouble});
  } else if (line.tongue == Tongue::kNone && line.rounds > 0) {
    remarks.push_back({line.device, line.bytes.total == 0
                                        ? std::string("says nothing at any rate") + (seen.asked ? "" : ": a sensor that waits to be asked shows itself with --ask")
                                        : "says something, but nothing that is known, at any rate"});
  } else if (line.answers) {
    remarks.push_back({line.device, "answers, but sends no samples: imu.rate_hz has slamd tell it to"});
  } else if (line.tongue == Tongue::kGnss) {
    judge_gnss(line.device, line.gnss, remarks);
  } else if (line.tongue != Tongue::kNone && line.imu.samples.total == 0) {
    remarks.push_back({line.device, "sends messages, but none with acceleration, turn rate and time: imu.rate_hz has slamd tell it to send them"});
  }
  judge_inertial(line.device, line.imu, R_base_imu, "imu.T_base_imu", remarks);
}

void judge_bus(const BusSeen& bus, const Eigen::Matrix3d* R_base_imu, Remarks& remarks) {
  if (!bus.trouble.empty()) {
    remarks.push_back({bus.interface, bus.trouble});
  } else if (bus.frames.total == 0) {
    remarks.push_back({bus.interface, "carries no frames: nobody speaks, or not at this bit rate"});
  }
  if (bus.lost > 0) {
    remarks.push_back({bus.interface, std::to_string(bus.lost) + " frames or more were lost"});
  }
  if (bus.bus_off > 0) {
    remarks.push_back({bus.interface, "was off the bus " + std::to_string(bus.bus_off) + " times: bit rate, or termination"});
  }
  judge_inertial(bus.interface + " xsens", bus.xsens, R_base_imu, "imu.T_base_imu", remarks);
  judge_inertial(bus.interface + " aceinna", bus.aceinna, R_base_imu, "imu.T_base_imu", remarks);
}

}  // namespace

std::vector<Remark> remarks_of(const Seen& seen, const std::optional<Configuration>& configuration) {
  const bool knows = configuration && configuration->imu.enabled;
  const Eigen::Matrix3d R_base_imu =
      knows ? configuration::resolved_odometry(*configuration).T_base_imu.rotation() : Eigen::Matrix3d::Identity();
  // For the sensor that the configuration means.
  const auto for_source = [&](bool is_meant) { return knows && is_meant ? &R_base_imu : nullptr; };

  Remarks remarks;
  judge_buffers(seen, remarks);
  for (const PortSeen& port : seen.ports) {
    judge_port(port, remarks);
  }
  for (const LidarSeen& lidar : seen.lidars) {
    judge_lidar(lidar, seen, remarks);
    if (lidar.imu) {
      const bool is_meant = knows && configuration->imu.source == "livox" && lidar.protocol == protocol_of(configuration->lidar.model);
      judge_inertial(name_of(lidar), *lidar.imu, for_source(is_meant), "lidar.T_base_lidar", remarks);
    }
  }
  for (const RowsSeen& rows : seen.rows) {
    const bool is_meant = knows && configuration->imu.source == "udp" && configuration->imu.port == rows.port;
    judge_inertial("CSV rows of " + dotted(rows.address), rows.imu, for_source(is_meant), "imu.T_base_imu", remarks);
  }
  for (const AviaSeen& avia : seen.avias) {
    judge_avia(avia, remarks);
  }
  if (!seen.hears_wire && seen.lidars.empty()) {
    remarks.push_back({"network", "no LiDAR is heard, and one of another subnet may be there: hearing what the kernel drops takes root, or CAP_NET_RAW"});
  }
  if (!seen.anything() && seen.listened_s >= kSilent_s) {
    remarks.push_back({"network", "nothing is heard at all: are sensors powered, is the link up, and do they send to this computer (" +
                                      subnets_in_words(seen.interfaces) + ")?"});
  }
  for (const std::uint32_t searcher : seen.searchers) {
    remarks.push_back({dotted(searcher), "another host looks for Livox SDK2 devices, and may take them"});
  }
  for (const LineSeen& line : seen.lines) {
    judge_line(line, seen, for_source(knows && configuration->imu.source == "serial" && line.device == configuration->imu.device), remarks);
  }
  for (const BusSeen& bus : seen.buses) {
    judge_bus(bus, for_source(knows && configuration->imu.source == "can" && bus.interface == configuration->imu.interface), remarks);
  }
  if (seen.left_out > 0) {
    remarks.push_back({"network", std::to_string(seen.left_out) + " datagrams come from more devices than are kept account of"});
  }
  return remarks;
}

std::string name_of(const LidarSeen& lidar) {
  return lidar.type + (lidar.code.empty() ? "" : " " + lidar.code) + " at " + dotted(lidar.address);
}

const char* name_of(Tongue tongue) {
  switch (tongue) {
    case Tongue::kXsens: return "Xsens MTData2";
    case Tongue::kMip: return "MicroStrain MIP";
    case Tongue::kCsv: return "CSV rows";
    case Tongue::kGnss: return "GNSS receiver";
    case Tongue::kNone: break;
  }
  return "unknown";
}

bool is_in_own_subnet(std::uint32_t address, const std::vector<transport::Interface>& interfaces) {
  for (const transport::Interface& interface : interfaces) {
    if ((address & interface.netmask) == (interface.address & interface.netmask)) {
      return true;
    }
  }
  return false;
}

std::string subnets_in_words(const std::vector<transport::Interface>& interfaces) {
  std::string words;
  for (const transport::Interface& interface : interfaces) {
    if (interface.broadcasts) {
      words += (words.empty() ? "" : ", ") + dotted(interface.address) + "/" + std::to_string(std::popcount(interface.netmask));
    }
  }
  return words.empty() ? "no address at all" : words;
}

}  // namespace slamd::sensors
