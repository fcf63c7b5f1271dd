#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "core/base/stamp.hpp"
#include "core/sensor/point.hpp"
#include "tools/import/recording_writer.hpp"

namespace slamd::importing {

/// Writes scans as a folder of clouds that drivers/clouds reads back to the nanosecond and the bit:
/// 000000.ply, ... (binary, x y z intensity ring tag, and offset_ns where the points have time),
/// and times.txt with one stamp each.
class CloudSequenceWriter {
 public:
  /// Makes the folder. Errors here and below: RecordingError.
  explicit CloudSequenceWriter(const std::filesystem::path& folder);

  /// Appends a scan. `stamp`: of its first point, or the end of a scan that is compensated.
  void write(std::span<const sensor::Point> points, bool has_time, Stamp stamp);

  void close();

  std::uint64_t scans() const { return scans_; }

 private:
  std::filesystem::path folder_;
  File times_;
  std::uint64_t scans_ = 0;
};

}  // namespace slamd::importing
