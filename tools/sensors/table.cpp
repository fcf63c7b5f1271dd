#include "tools/sensors/table.hpp"

#include <algorithm>
#include <cstdio>

#include "drivers/transport/udp_receiver.hpp"
#include "tools/sensors/gravity.hpp"

namespace slamd::sensors {

using transport::dotted;

namespace {

/// Strings things together that happened a second; those that never happened are left out.
class Rates {
 public:
  void add(const Count& count, const char* what) {
    if (count.total > 0) {
      add(std::to_string(count.last_second) + " " + what + "/s");
    }
  }
  void add(const std::string& words) { text_ += (text_.empty() ? "" : ", ") + words; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string formatted(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void add_inertial(const InertialSeen& imu, Rates& rates) {
  rates.add(imu.samples, "samples");
  if (imu.samples.last_second > 0) {
    rates.add(formatted("%.2f m/s^2", imu.mean_force_mps2.norm()) + (imu.shows_gravity() ? ", up is " + up_axis(imu.mean_force_mps2) : ""));
  }
}

const char* words_of(TimeSource time) {
  switch (time) {
    case TimeSource::kPtp: return "PTP";
    case TimeSource::kGps: return "GPS";
    case TimeSource::kPps: return "PPS";
    default: return "";
  }
}

Row row_of(const LidarSeen& lidar) {
  Rates rates;
  rates.add(lidar.broadcasts, lidar.protocol == LidarProtocol::kSdk2 ? "answers" : "broadcasts");
  rates.add(lidar.packets, "packets");
  rates.add(lidar.points, "points");
  rates.add(lidar.positions, "position packets");
  if (lidar.imu) {
    add_inertial(*lidar.imu, rates);
  }
  if (const std::string time = words_of(lidar.time); !time.empty()) {
    rates.add("time of " + time);
  }
  if (lidar.pps == velodyne::PpsState::kLocked) {
    rates.add(std::string("PPS locked"));
  }
  return {lidar.type + (lidar.code.empty() ? "" : " " + lidar.code), dotted(lidar.address), rates.text()};
}

Row row_of(const RowsSeen& rows) {
  Rates rates;
  rates.add("UDP port " + std::to_string(rows.port));
  add_inertial(rows.imu, rates);
  return {name_of(Tongue::kCsv), dotted(rows.address), rates.text()};
}

Row row_of(const LineSeen& line) {
  if (!line.trouble.empty()) {
    return {"serial line", line.device, line.trouble};
  }
  Rates rates;
  if (line.tongue == Tongue::kNone) {
    rates.add(std::string("listening at ") + std::to_string(line.baud) + " baud");
    rates.add(line.bytes, "bytes");
    return {"serial line", line.device, rates.text()};
  }
  rates.add(std::to_string(line.baud) + " baud");
  if (line.tongue == Tongue::kGnss) {
    rates.add(line.gnss.sentences, "sentences");
    rates.add(line.gnss.ubx, "UBX");
    rates.add(line.gnss.good, "good fixes");
    rates.add(std::to_string(line.gnss.satellites) + " satellites");
  }
  add_inertial(line.imu, rates);
  return {name_of(line.tongue), line.device, rates.text()};
}

void add_rows(const BusSeen& bus, std::vector<Row>& rows) {
  Rates rates;
  rates.add(bus.frames, "frames");
  rates.add(bus.trouble.empty() ? std::to_string(bus.ids.size()) + " ids" : bus.trouble);
  rows.push_back({"CAN bus", bus.interface, rates.text()});
  for (const auto& [name, imu] : {std::pair("Xsens MTi-600", &bus.xsens), std::pair("Aceinna", &bus.aceinna)}) {
    if (imu->samples.total > 0) {
      Rates inertial;
      add_inertial(*imu, inertial);
      rows.push_back({name, bus.interface, inertial.text()});
    }
  }
  for (const CanIdSeen& id : bus.ids) {
    char name[32];
    std::snprintf(name, sizeof name, id.is_extended ? "  id %08X" : "  id %03X", id.id);
    Rates frames;
    frames.add(id.frames, "frames");
    frames.add(std::to_string(id.size) + " bytes");
    rows.push_back({name, bus.interface, frames.text()});
  }
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 0, ' ');
}

/// Breaks a text into lines at blanks, those after the first indented, unless that leaves no room.
void wrap(std::string text, std::size_t columns, std::size_t indent, std::vector<std::string>& lines) {
  indent = indent > columns / 2 ? 4 : indent;
  while (text.size() > columns) {
    std::size_t at = text.rfind(' ', columns);
    at = at == std::string::npos || at <= indent ? columns : at;
    lines.push_back(text.substr(0, at));
    const std::size_t next = text.find_first_not_of(' ', at);
    text = std::string(indent, ' ') + (next == std::string::npos ? "" : text.substr(next));
  }
  lines.push_back(text);
}

}  // namespace

std::vector<Row> rows_of(const Seen& seen) {
  std::vector<Row> rows;
  for (const LidarSeen& lidar : seen.lidars) {
    rows.push_back(row_of(lidar));
  }
  for (const RowsSeen& sender : seen.rows) {
    rows.push_back(row_of(sender));
  }
  for (const LineSeen& line : seen.lines) {
    rows.push_back(row_of(line));
  }
  for (const BusSeen& bus : seen.buses) {
    add_rows(bus, rows);
  }
  return rows;
}

std::string draw(const Seen& seen, const std::vector<Remark>& remarks, const Look& look) {
  constexpr std::size_t kNarrowest = 20;
  const std::size_t columns = std::max(look.columns, kNarrowest);
  std::vector<std::string> lines{"slamd-sensors: listening for " + formatted("%.0f", seen.listened_s) + " s"};
  const std::vector<Row> rows = rows_of(seen);
  std::size_t name_width = 0;
  std::size_t place_width = 0;
  for (const Row& row : rows) {
    name_width = std::max(name_width, row.name.size());
    place_width = std::max(place_width, row.place.size());
  }
  for (const Row& row : rows) {
    const std::string place = "  " + padded(row.name, name_width) + "  " + padded(row.place, place_width) + "  ";
    wrap(place + row.rates, columns, place.size(), lines);
  }
  if (rows.empty()) {
    lines.emplace_back("  nothing heard yet");
  }
  for (const Remark& remark : remarks) {
    wrap("! " + remark.about + ": " + remark.words, columns, 4, lines);
  }
  std::string text;
  for (std::size_t i = 0; i < lines.size() && i < std::max<std::size_t>(look.rows, 1); ++i) {
    text += lines[i] + "\n";
  }
  return text;
}

std::string second_as_lines(const Seen& seen) {
  std::string text;
  for (const Row& row : rows_of(seen)) {
    text += formatted("%4.0f s  ", seen.listened_s) + row.name + "  " + row.place + "  " + row.rates + "\n";
  }
  return text.empty() ? formatted("%4.0f s  nothing heard\n", seen.listened_s) : text;
}

std::string remarks_as_lines(const std::vector<Remark>& remarks) {
  std::string text;
  for (const Remark& remark : remarks) {
    text += "! " + remark.about + ": " + remark.words + "\n";
  }
  return text.empty() ? "nothing to remark\n" : text;
}

}  // namespace slamd::sensors
