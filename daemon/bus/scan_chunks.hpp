#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/bounded_vector.hpp"
#include "daemon/bus/messages.hpp"

namespace slamd::bus {

/// A part of a scan, as one message carries it. Points of odom, relative to origin_odom.
/// Units: points in cm, the rest in m.
struct ScanChunk {
  static constexpr std::size_t kPoints = 200;
  static constexpr std::size_t kMaxChunks = 500;
  using Point = std::array<std::int16_t, 3>;

  std::uint64_t scan_index = 0;
  Stamp stamp{};
  std::uint16_t index = 0;
  std::uint16_t count = 0;
  std::uint32_t scan_crc32 = 0;  // of all points of the scan, as they stand in the messages
  geometry::Se3 T_odom_base;
  Eigen::Vector3d origin_odom = Eigen::Vector3d::Zero();
  FixedVector<Point, kPoints> points_cm;
};

/// Decimates a scan and cuts it into chunks.
/// Real-time: allocates in the constructor only.
class ScanChunker {
 public:
  /// At most kMaxChunks * kPoints, 100,000.
  explicit ScanChunker(std::size_t max_points);

  /// Takes a scan in: every n-th point, so that no more than max_points remain; what is farther than 327 m from base
  /// along an axis is left out. Returns the number of chunks, at least 1 unless max_points is 0.
  std::size_t begin(const Scan& scan);

  /// The chunk of this index, until the next begin().
  const ScanChunk& chunk(std::size_t index);

 private:
  std::size_t max_points_;
  BoundedVector<ScanChunk::Point> points_cm_;  // scratch, sized once
  ScanChunk chunk_;
};

/// A scan as a client sees it.
/// Frames: points in odom, rounded to 1 cm.  Units: m.
struct AssembledScan {
  std::uint64_t scan_index = 0;
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  std::vector<Eigen::Vector3d> points_odom;
};

/// Puts the chunks of scans together again, in whatever order they come; one scan at a time: the chunk of a newer scan
/// ends the one before.
class ScanAssembly {
 public:
  /// Returns the scan that this chunk completes.
  std::optional<AssembledScan> add(const ScanChunk& chunk);

  std::uint64_t incomplete() const { return incomplete_; }  // scans that a newer one ended
  std::uint64_t corrupt() const { return corrupt_; }        // scans whose CRC was wrong
  std::uint64_t late() const { return late_; }              // chunks of scans that are over, and second ones

 private:
  void begin(const ScanChunk& chunk);

  std::optional<ScanChunk> head_;  // the scan being assembled
  std::vector<FixedVector<ScanChunk::Point, ScanChunk::kPoints>> parts_;
  std::vector<bool> seen_;
  std::size_t missing_ = 0;
  std::uint64_t incomplete_ = 0;
  std::uint64_t corrupt_ = 0;
  std::uint64_t late_ = 0;
};

}  // namespace slamd::bus
