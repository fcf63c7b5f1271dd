#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/stamp.hpp"
#include "core/sensor/point_block.hpp"
#include "drivers/livox/data_header.hpp"
#include "drivers/livox/decode_result.hpp"
#include "drivers/livox/imu_reading.hpp"
#include "drivers/livox/status_code.hpp"

namespace slamd::livox {

/// The defaults are the Avia's.
struct LivoxConfig {
  std::uint32_t firings_per_second = 240'000;  // Mid-40 and Mid-70: 100,000
  std::uint8_t lines = 6;                      // Mid-40 and Mid-70: 1
  double min_range_m = 0.1;                    // nearer returns come from the sensor's own window
  double max_range_m = 460.0;
};

/// Decodes the data packets of a Livox that speaks SDK1 (livox-sdk1.md §5): data types 0 to 8.
///
/// A point's line is its firing's index modulo the number of lines, its offset_ns the firing's
/// index over the firing rate, rounded (never summed up, so it does not drift), its echo the place
/// among the returns of one firing. Firings without a return (zero coordinates, zero depth) have no
/// point but count as empty_firings. Real-time: never allocates; O(points); one thread.
class LivoxDecoder {
 public:
  /// Errors: a rate or a number of lines of 0, or an empty range gate, is a programmer error.
  explicit LivoxDecoder(const LivoxConfig& config);

  /// Decodes one datagram: kPoints fills block (but for its stamp, which is the ClockModel's to
  /// set), kImu fills imu. Errors: any refusal is counted by reason and leaves both untouched. Any
  /// bytes may be given.
  DecodeResult decode(std::span<const std::byte> payload,
                      Stamp received,
                      sensor::PointBlock& block,
                      ImuReading& imu);

  /// The header of the last packet that was not refused; its timestamp type may change when the
  /// sensor (un)locks.
  const DataHeader& last_header() const { return last_header_; }

  StatusCode last_status() const { return parse_status_code(last_header_.status_code); }

  const LivoxCounters& counters() const { return counters_; }

 private:
  struct Layout;

  DecodeResult decode_checked(std::span<const std::byte> payload,
                              Stamp received,
                              sensor::PointBlock& block,
                              ImuReading& imu);
  void decode_points(const Layout& layout,
                     std::span<const std::byte> bytes,
                     sensor::PointBlock& block);
  bool decode_cartesian(const Layout& layout,
                        std::span<const std::byte> firing,
                        sensor::Point point,
                        sensor::PointBlock& block);
  bool decode_spherical(const Layout& layout,
                        std::span<const std::byte> firing,
                        sensor::Point point,
                        sensor::PointBlock& block);
  void append(const std::array<double, 3>& p_lidar_m,
              sensor::Point point,
              sensor::PointBlock& block);

  static constexpr std::size_t kMaxFirings = 100;  // of one packet

  LivoxConfig config_;
  std::array<std::uint32_t, kMaxFirings + 1> offset_ns_{};  // by firing, from the packet's first; the last: the next packet's
  std::array<std::uint8_t, kMaxFirings> line_{};            // by firing
  DataHeader last_header_;
  LivoxCounters counters_;
};

}  // namespace slamd::livox
