#include "tools/import/cloud_sequence.hpp"

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"

namespace slamd::importing {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kPointBytes = 16;
constexpr std::size_t kTimedPointBytes = 20;

std::string header(std::size_t points, bool has_time) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uint8 tag\n"
         "property uint8 ring\nproperty uint8 echo\nproperty uint8 intensity\n" +
         (has_time ? "property uint offset_ns\n" : "") + "end_header\n";
}

}  // namespace

CloudSequenceWriter::CloudSequenceWriter(const fs::path& folder)
    : folder_(folder), times_(nullptr, std::fclose) {
  fs::create_directories(folder);
  times_ = create_file(folder / "times.txt");
}

void CloudSequenceWriter::write(std::span<const sensor::Point> points, bool has_time, Stamp stamp) {
  const std::size_t record = has_time ? kTimedPointBytes : kPointBytes;
  std::vector<std::byte> bytes(points.size() * record);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const sensor::Point& point = points[i];
    const std::span<std::byte> at = std::span(bytes).subspan(i * record, record);
    store_le(at, 0, point.x_m);
    store_le(at, 4, point.y_m);
    store_le(at, 8, point.z_m);
    store_le(at, 12, point.tag);
    store_le(at, 13, point.line);
    store_le(at, 14, point.echo);
    store_le(at, 15, point.intensity);
    if (has_time) {
      store_le(at, 16, point.offset_ns);
    }
  }
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%06llu.ply", static_cast<unsigned long long>(scans_));
  const fs::path path = folder_ / name.data();
  File file = create_file(path);
  const std::string head = header(points.size(), has_time);
  std::fwrite(head.data(), 1, head.size(), file.get());
  std::fwrite(bytes.data(), 1, bytes.size(), file.get());
  close_file(file, path);
  const std::int64_t ns = stamp.time_since_epoch().count();
  std::fprintf(times_.get(),
               "%s%lld.%09lld\n",
               ns < 0 ? "-" : "",
               std::llabs(ns / 1'000'000'000),
               std::llabs(ns % 1'000'000'000));
  ++scans_;
}

void CloudSequenceWriter::close() {
  close_file(times_, folder_ / "times.txt");
}

}  // namespace slamd::importing
