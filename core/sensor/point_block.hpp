#pragma once

#include <cstdint>

#include "core/base/fixed_vector.hpp"
#include "core/base/stamp.hpp"
#include "core/sensor/point.hpp"

namespace slamd::sensor {

/// One firing sequence of a spinning sensor: all lasers once. A scan may be cut between two sequences only.
struct Sequence {
  std::uint16_t first_point = 0;   // index into PointBlock::points; its points end where the next one's begin
  std::uint16_t azimuth_cdeg = 0;  // 0..35999, hundredths of a degree as on the wire, clockwise from +x of lidar
  std::uint32_t offset_ns = 0;     // of its first firing, from the block's stamp
};

/// The returns of one packet, in firing order; firings without a return have no point.
/// A Livox block has no sequences: its scans are cut by time.
struct PointBlock {
  static constexpr std::size_t kMaxPoints = 768;    // VLP-16 dual: 24 sequences × 16 lasers × 2 returns
  static constexpr std::size_t kMaxSequences = 24;  // VLP-16: 12 blocks × 2 sequences

  DeviceStamp device_stamp{};     // of the first firing, on the sensor's clock
  Stamp stamp{};                  // the same on the time base, set by the sensor's ClockModel
  Stamp received{};               // arrival at the host
  Duration duration{};            // from the first firing of this packet to that of the next
  std::uint32_t empty_firings = 0;  // firings without a return
  FixedVector<Point, kMaxPoints> points;
  FixedVector<Sequence, kMaxSequences> sequences;
};

}  // namespace slamd::sensor
