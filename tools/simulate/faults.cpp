#include "tools/simulate/faults.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "drivers/recording/pcap_reader.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "tools/simulate/fault_injector.hpp"
#include "tools/simulate/scene.hpp"
#include "tools/simulate/text_file.hpp"

namespace slamd::simulate {

namespace fs = std::filesystem;
using recording::RecordingError;

namespace {

bool is_capture(const fs::path& file) { return file.extension() == ".pcap" || file.extension() == ".pcapng"; }

/// What is in a capture.
struct Extent {
  std::uint64_t packets = 0;
  double length_s = 0.0;
};

Extent extent_of(const fs::path& file) {
  recording::PcapReader reader(file);
  Extent extent;
  std::optional<Stamp> first;
  for (recording::Packet packet; reader.next(packet); ++extent.packets) {
    first = first.value_or(packet.received);
    extent.length_s = std::max(extent.length_s, to_seconds(packet.received - *first));
  }
  return extent;
}

void damage_capture(const fs::path& in, const fs::path& out, FaultInjector& injector, std::uint64_t packets,
                    const std::function<void(double)>& progress) {
  recording::PcapReader reader(in);
  recording::PcapWriter writer(out);
  const auto write = [&](const recording::Packet& packet) { writer.write(packet, kHostAddress); };
  recording::Packet packet;
  for (std::uint64_t i = 0; reader.next(packet); ++i) {
    injector.add(packet, write);
    if (progress && i % 1000 == 0) {
      progress(static_cast<double>(i) / static_cast<double>(packets));
    }
  }
  injector.finish(write);
  writer.close();
  for (std::size_t kind = 0; kind < recording::kFrameKinds; ++kind) {
    injector.counts().frames_not_udp +=
        kind == static_cast<std::size_t>(recording::FrameKind::kUdp) ? 0 : reader.counters().frames[kind];
  }
}

/// Which columns of an inertial file hold what can be clipped.
struct ImuColumns {
  struct Column {
    double limit = 0.0;  // 0: none
    const char* format = kRateFormat;
  };
  std::vector<Column> columns;

  ImuColumns(const std::string& header, const std::optional<InertialLimits>& clip) {
    std::istringstream names(header);
    for (std::string name; std::getline(names, name, ',');) {
      const bool gyro = name.rfind("g", 0) == 0 && name.find("_rad_s") == 2;
      const bool accel = name.rfind("a", 0) == 0 && name.find("_m_s2") == 2;
      columns.push_back({!clip ? 0.0 : gyro ? clip->rate_radps : accel ? clip->force_mps2 : 0.0,
                         gyro ? kRateFormat : kForceFormat});
    }
  }
};

/// Cuts the values of a row; tells whether any was beyond its limit.
bool clip_row(std::vector<std::string>& cells, const std::vector<ImuColumns::Column>& columns) {
  bool clipped = false;
  for (std::size_t i = 1; i < std::min(cells.size(), columns.size()); ++i) {
    const auto& [limit, format] = columns[i];
    const double value = std::strtod(cells[i].c_str(), nullptr);
    if (limit > 0.0 && std::abs(value) > limit) {
      char text[48];
      std::snprintf(text, sizeof text, format, std::copysign(limit, value));
      cells[i] = text;
      clipped = true;
    }
  }
  return clipped;
}

void damage_imu(const fs::path& in, const fs::path& out, const Faults& faults, FaultInjector& injector) {
  std::ifstream stream(in);
  std::string line;
  if (!std::getline(stream, line)) {
    throw RecordingError(in, "cannot be read");
  }
  const ImuColumns columns(line, faults.imu_clip);
  TextFile file(out);
  std::fprintf(file.stream(), "%s\n", line.c_str());
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) {
      cells.push_back(cell);
    }
    if (cells.empty()) {
      continue;
    }
    Stamp stamp(Duration(std::strtoll(cells[0].c_str(), nullptr, 10)));
    if (!injector.pass_row(stamp)) {
      continue;
    }
    cells[0] = std::to_string(stamp.time_since_epoch().count());
    injector.counts().imu_rows_clipped += clip_row(cells, columns.columns) ? 1 : 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::fprintf(file.stream(), "%s%s", i == 0 ? "" : ",", cells[i].c_str());
    }
    std::fputc('\n', file.stream());
  }
  file.close();
}

}  // namespace

FaultCounts inject_faults(const fs::path& in, const fs::path& out, const Faults& faults,
                          const std::function<void(double)>& progress) {
  if (!fs::exists(in)) {
    throw RecordingError(in, "does not exist");
  }
  std::vector<fs::path> files;
  if (fs::is_directory(in)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(in)) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
  } else {
    files.push_back(in);
  }
  Extent extent;
  for (const fs::path& file : files) {
    extent = is_capture(file) ? extent_of(file) : extent;
  }
  FaultInjector injector(faults, std::ceil(extent.length_s));
  for (const fs::path& file : files) {
    const fs::path copy = out / file.filename();
    if (is_capture(file)) {
      damage_capture(file, copy, injector, extent.packets, progress);
    } else if (file.filename() == "imu.csv") {
      damage_imu(file, copy, faults, injector);
    } else if (file.filename() != "faults.json") {
      fs::copy(file, copy, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    }
  }
  write_faults(faults, injector.counts(), out / "faults.json");
  return injector.counts();
}

void write_faults(const Faults& faults, const FaultCounts& counts, const fs::path& file) {
  TextFile report(file);
  std::fputs(faults_json(faults, counts).c_str(), report.stream());
  report.close();
}

}  // namespace slamd::simulate
