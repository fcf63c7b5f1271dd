#include "drivers/clouds/point_folder.hpp"

#include <algorithm>
#include <fstream>

#include "core/base/assert.hpp"
#include "drivers/clouds/pcd.hpp"
#include "drivers/clouds/ply.hpp"

namespace slamd::clouds {

namespace {

bool read_file(const std::filesystem::path& path, std::vector<std::byte>& bytes) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : -1;
  if (size < 0) {
    return false;
  }
  bytes.resize(static_cast<std::size_t>(size));
  stream.seekg(0);
  return bytes.empty() || stream.read(reinterpret_cast<char*>(bytes.data()), size).gcount() == size;
}

}  // namespace

std::optional<CloudRefusal> read_cloud_file(const std::filesystem::path& path,
                                            std::vector<std::byte>& bytes,
                                            RawCloud& cloud) {
  if (!read_file(path, bytes)) {
    return CloudRefusal::kUnreadable;
  }
  if (path.extension() == ".pcd") {
    return parse_pcd(bytes, cloud);
  }
  return path.extension() == ".ply" ? parse_ply(bytes, cloud) : parse_bin(bytes, cloud);
}

PointFolderReader::PointFolderReader(const std::filesystem::path& folder,
                                     const PointFolderOptions& options)
    : options_(options), list_(list_clouds(folder)), converter_(options.points_have_time) {
  SLAMD_ASSERT(options.scans_per_second > 0.0);
}

bool PointFolderReader::next(sensor::Scan& scan) {
  while (next_file_ < list_.files.size()) {
    const std::size_t file = next_file_++;
    const auto refusal = read(file, scan);
    if (!refusal) {
      scan.index = counters_.scans++;
      last_end_ = scan.end;
      return true;
    }
    ++counters_.refused[static_cast<std::size_t>(*refusal)];
    if (counters_.first_refused.empty()) {
      counters_.first_refused =
          list_.files[file].path.filename().string() + ": " + std::string(name_of(*refusal));
    }
  }
  return false;
}

std::optional<CloudRefusal> PointFolderReader::read(std::size_t file, sensor::Scan& scan) {
  if (const auto refusal = read_cloud_file(list_.files[file].path, bytes_, raw_)) {
    return refusal;
  }
  if (const auto refusal = converter_.convert(raw_, cloud_)) {
    return refusal;
  }
  if (const auto refusal = set_period(file, scan)) {
    return refusal;
  }
  copy_points(scan);
  return std::nullopt;
}

std::optional<CloudRefusal> PointFolderReader::set_period(std::size_t file, sensor::Scan& scan) {
  const Duration period = from_seconds(1.0 / options_.scans_per_second);
  const std::optional<Stamp> known = list_.files[file].stamp;
  if (list_.stamps_are_known && !known) {
    return CloudRefusal::kNoStamp;
  }
  // By its number, never as a sum of rounded periods.
  const Stamp by_rate =
      Stamp{} + from_seconds(static_cast<double>(file + 1) / options_.scans_per_second);
  const ScanPlace place = place_in_time(cloud_, known, by_rate, period);
  if (last_end_ && place.end <= *last_end_) {
    return CloudRefusal::kStampNotIncreasing;
  }
  stamp_source_ =
      place.by_points ? StampSource::kPointTimes : (known ? list_.source : StampSource::kRate);
  scan.begin = last_end_ && !cloud_.has_time ? std::max(place.begin, *last_end_) : place.begin;
  scan.end = place.end;
  return std::nullopt;
}

void PointFolderReader::copy_points(sensor::Scan& scan) {
  const std::size_t fitting = std::min(cloud_.points.size(), scan.points.capacity());
  scan.points.assign(std::span(cloud_.points).first(fitting));
  scan.points_have_time = cloud_.has_time;
  scan.complete = true;
  scan.points_dropped = static_cast<std::uint32_t>(cloud_.points.size() - fitting);
  counters_.points += fitting;
  counters_.empty += cloud_.empty;
  counters_.over_capacity += cloud_.points.size() - fitting;
}

}  // namespace slamd::clouds
