#include "tools/sensors/json.hpp"

#include <nlohmann/json.hpp>

#include "drivers/transport/udp_receiver.hpp"

namespace slamd::sensors {

using transport::dotted;

namespace {

using Json = nlohmann::ordered_json;

Json of(const Count& count) { return {{"total", count.total}, {"last_second", count.last_second}}; }

Json of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

const char* name_of(imu::Units units) {
  switch (units) {
    case imu::Units::kSi: return "si";
    case imu::Units::kInG: return "g";
    case imu::Units::kNoGravity: return "no_gravity";
    case imu::Units::kInDegrees: return "degrees";
    case imu::Units::kUnknown: break;
  }
  return "unknown";
}

const char* name_of(TimeSource time) {
  switch (time) {
    case TimeSource::kFreeRunning: return "free_running";
    case TimeSource::kPtp: return "ptp";
    case TimeSource::kGps: return "gps";
    case TimeSource::kPps: return "pps";
    case TimeSource::kUnknown: break;
  }
  return "unknown";
}

const char* name_of(velodyne::PpsState pps) {
  switch (pps) {
    case velodyne::PpsState::kNone: return "none";
    case velodyne::PpsState::kSynchronising: return "synchronising";
    case velodyne::PpsState::kLocked: return "locked";
    case velodyne::PpsState::kError: return "error";
    case velodyne::PpsState::kUnknown: break;
  }
  return "unknown";
}

const char* name_of_tongue(Tongue tongue) {
  switch (tongue) {
    case Tongue::kXsens: return "xsens";
    case Tongue::kMip: return "mip";
    case Tongue::kCsv: return "csv";
    case Tongue::kGnss: return "gnss";
    case Tongue::kNone: break;
  }
  return "none";
}

Json of(const InertialSeen& imu) {
  return {{"samples", of(imu.samples)},
          {"refused", imu.refused},
          {"missing", imu.missing},
          {"clipped", imu.clipped},
          {"units", name_of(imu.units)},
          {"mean_force_mps2", of(imu.mean_force_mps2)},
          {"mean_rate_radps", of(imu.mean_rate_radps)}};
}

Json of(const LidarSeen& lidar) {
  Json result{{"type", lidar.type},
              {"model", lidar.model ? Json(configuration::name_of(*lidar.model)) : Json()},
              {"code", lidar.code},
              {"address", dotted(lidar.address)},
              {"broadcasts", of(lidar.broadcasts)},
              {"packets", of(lidar.packets)},
              {"points", of(lidar.points)},
              {"positions", of(lidar.positions)},
              {"refused", lidar.refused},
              {"time", name_of(lidar.time)},
              {"pps", lidar.pps ? Json(name_of(*lidar.pps)) : Json()},
              {"sentence", lidar.sentence},
              {"sends_to", lidar.sends_to ? Json(dotted(*lidar.sends_to)) : Json()}};
  result["imu"] = lidar.imu ? of(*lidar.imu) : Json();
  return result;
}

Json of(const RowsSeen& rows) { return {{"address", dotted(rows.address)}, {"port", rows.port}, {"imu", of(rows.imu)}}; }

Json of(const LineSeen& line) {
  Json result{{"device", line.device},     {"trouble", line.trouble}, {"baud", line.baud},         {"found", line.found},
              {"speaks", name_of_tongue(line.tongue)}, {"answers", line.answers}, {"bytes", of(line.bytes)}};
  if (line.tongue == Tongue::kGnss) {
    result["gnss"] = {{"sentences", of(line.gnss.sentences)}, {"ubx", of(line.gnss.ubx)},        {"fixes", of(line.gnss.fixes)},
                      {"good", of(line.gnss.good)},           {"lacks", line.gnss.lacks},        {"satellites", line.gnss.satellites},
                      {"quality", line.gnss.quality}};
  } else {
    result["imu"] = of(line.imu);
  }
  return result;
}

Json of(const BusSeen& bus) {
  Json result{{"interface", bus.interface}, {"trouble", bus.trouble}, {"frames", of(bus.frames)}, {"lost", bus.lost},
              {"bus_off", bus.bus_off},     {"xsens", of(bus.xsens)}, {"aceinna", of(bus.aceinna)}, {"ids", Json::array()}};
  for (const CanIdSeen& id : bus.ids) {
    result["ids"].push_back({{"id", id.id}, {"extended", id.is_extended}, {"bytes", id.size}, {"frames", of(id.frames)}});
  }
  return result;
}

Json of(const PortSeen& port) {
  return {{"port", port.port},   {"purpose", port.purpose},     {"owner", port.owner},
          {"buffer", port.buffer}, {"datagrams", of(port.datagrams)}, {"strange", of(port.strange)}, {"lost", port.lost}};
}

template <typename Items>
Json list(const Items& items) {
  Json result = Json::array();
  for (const auto& item : items) {
    result.push_back(of(item));
  }
  return result;
}

}  // namespace

std::string to_json(const Seen& seen, const std::vector<Remark>& remarks) {
  Json result{{"listened_s", seen.listened_s}, {"lidars", list(seen.lidars)}, {"rows", list(seen.rows)}, {"lines", list(seen.lines)},
              {"buses", list(seen.buses)},     {"ports", list(seen.ports)},   {"remarks", Json::array()}};
  for (const AviaSeen& avia : seen.avias) {
    constexpr const char* kAnswers[] = {"not_asked", "none", "refusal", "consent"};
    result["avias"].push_back({{"address", dotted(avia.address)}, {"answer", kAnswers[static_cast<std::size_t>(avia.answer)]}});
  }
  for (const Remark& remark : remarks) {
    result["remarks"].push_back({{"about", remark.about}, {"words", remark.words}});
  }
  return result.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace slamd::sensors
