#include "tools/simulate/faults.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "drivers/recording/pcap_reader.hpp"
#include "tools/simulate/faulty_capture.hpp"
#include "tools/simulate/text_file.hpp"

namespace slamd::simulate {

namespace fs = std::filesystem;
using recording::RecordingError;

namespace {

bool is_capture(const fs::path& file) { return file.extension() == ".pcap" || file.extension() == ".pcapng"; }

std::uint64_t packets_in(const fs::path& file) {
  recording::PcapReader reader(file);
  recording::Packet packet;
  std::uint64_t count = 0;
  while (reader.next(packet)) {
    ++count;
  }
  return count;
}

void damage_capture(const fs::path& in, const fs::path& out, const Faults& faults, FaultCounts& counts,
                    const std::function<void(double)>& progress) {
  const std::uint64_t total = packets_in(in);
  recording::PcapReader reader(in);
  FaultyCapture capture(out, faults, total, counts);
  recording::Packet packet;
  for (std::uint64_t i = 0; reader.next(packet); ++i) {
    capture.add(packet);
    if (progress && i % 1000 == 0) {
      progress(static_cast<double>(i) / static_cast<double>(total));
    }
  }
  capture.close();
  for (std::size_t kind = 0; kind < recording::kFrameKinds; ++kind) {
    counts.frames_not_udp +=
        kind == static_cast<std::size_t>(recording::FrameKind::kUdp) ? 0 : reader.counters().frames[kind];
  }
}

/// Which columns of an inertial file hold what can be clipped.
struct ImuColumns {
  std::vector<double> limits;  // of each column; 0: none

  ImuColumns(const std::string& header, const std::optional<InertialLimits>& clip) {
    std::istringstream names(header);
    for (std::string name; std::getline(names, name, ',');) {
      const bool gyro = name.rfind("g", 0) == 0 && name.find("_rad_s") == 2;
      const bool accel = name.rfind("a", 0) == 0 && name.find("_m_s2") == 2;
      limits.push_back(!clip ? 0.0 : gyro ? clip->rate_radps : accel ? clip->force_mps2 : 0.0);
    }
  }
};

/// Cuts the values of a row; tells whether any was beyond its limit.
bool clip_row(std::vector<std::string>& cells, const ImuColumns& columns) {
  bool clipped = false;
  for (std::size_t i = 1; i < std::min(cells.size(), columns.limits.size()); ++i) {
    const double limit = columns.limits[i];
    const double value = std::strtod(cells[i].c_str(), nullptr);
    if (limit > 0.0 && std::abs(value) > limit) {
      char text[48];
      std::snprintf(text, sizeof text, "%.7f", std::copysign(limit, value));
      cells[i] = text;
      clipped = true;
    }
  }
  return clipped;
}

void damage_imu(const fs::path& in, const fs::path& out, const Faults& faults, FaultCounts& counts) {
  std::ifstream stream(in);
  std::string line;
  if (!std::getline(stream, line)) {
    throw RecordingError(in, "cannot be read");
  }
  const ImuColumns columns(line, faults.imu_clip);
  TextFile file(out);
  std::fprintf(file.stream(), "%s\n", line.c_str());
  std::optional<std::int64_t> first_ns;
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) {
      cells.push_back(cell);
    }
    if (cells.empty()) {
      continue;
    }
    ++counts.imu_rows_read;
    const std::int64_t stamp_ns = std::strtoll(cells[0].c_str(), nullptr, 10);
    first_ns = first_ns.value_or(stamp_ns);
    const double t_s = 1e-9 * static_cast<double>(stamp_ns - *first_ns);
    if (std::any_of(faults.imu_gaps.begin(), faults.imu_gaps.end(),
                    [&](const Event& e) { return t_s >= e.at_s && t_s < e.at_s + e.by_s; })) {
      ++counts.imu_rows_gap;
      continue;
    }
    cells[0] = std::to_string(stamp_ns + from_seconds(faults.imu_offset_s).count());
    counts.imu_rows_clipped += clip_row(cells, columns) ? 1 : 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      std::fprintf(file.stream(), "%s%s", i == 0 ? "" : ",", cells[i].c_str());
    }
    std::fputc('\n', file.stream());
    ++counts.imu_rows_written;
  }
  file.close();
}

}  // namespace

FaultCounts inject_faults(const fs::path& in, const fs::path& out, const Faults& faults,
                          const std::function<void(double)>& progress) {
  if (!fs::exists(in)) {
    throw RecordingError(in, "does not exist");
  }
  FaultCounts counts;
  std::vector<fs::path> files;
  if (fs::is_directory(in)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(in)) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
  } else {
    files.push_back(in);
  }
  for (const fs::path& file : files) {
    const fs::path copy = out / file.filename();
    if (is_capture(file)) {
      damage_capture(file, copy, faults, counts, progress);
    } else if (file.filename() == "imu.csv") {
      damage_imu(file, copy, faults, counts);
    } else if (file.filename() != "faults.json") {
      fs::copy(file, copy, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    }
  }
  TextFile report(out / "faults.json");
  std::fputs(faults_json(faults, counts).c_str(), report.stream());
  report.close();
  return counts;
}

}  // namespace slamd::simulate
