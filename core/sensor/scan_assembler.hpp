#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/stamp.hpp"
#include "core/sensor/point_block.hpp"
#include "core/sensor/scan.hpp"
#include "core/sensor/stamp_gate.hpp"

namespace slamd::sensor {

/// Says where one scan ends and the next one begins.
enum class CutRule : std::uint8_t {
  kAzimuth,  // spinning: where the azimuth passes the cut angle, between two firing sequences
  kPeriod,   // Livox: every period, between two points
};

struct ScanAssemblerConfig {
  CutRule rule = CutRule::kAzimuth;
  // Behind the vehicle, so that the seam of old and new is not in its way.
  double cut_azimuth_deg = 180.0;
  // kPeriod: length of a scan. kAzimuth: of a revolution, until the first packet has shown it.
  Duration period = std::chrono::milliseconds{100};
  // Per scan; a VLP-16 with dual returns at 5 Hz makes 120,000.
  std::size_t max_points = 131072;
  // Of a revolution or period; a scan that saw less is incomplete.
  double min_complete_fraction = 0.99;
};

/// Says why a block did not enter a scan.
enum class BlockRefusal : std::uint8_t {
  kDuplicate,  // same stamp as the last block
  kLate,       // older than the middle of the last block, by up to a period: reordered on its way
  kBackward,   // older by more: the clock went backward
  kMalformed,  // sequences or duration contradict themselves or the rule
  kFarAhead,   // newer by more than kLeap, and the next one is not: a wild stamp
};

inline constexpr std::size_t kBlockRefusals = 5;

/// Names a reason as reports and health spell it.
std::string_view to_string(BlockRefusal reason);

/// What happened to blocks and points since construction. Of the points in accepted blocks, each is
/// in a scan that came out, in the one being filled, or counted in points_over_capacity,
/// points_unplaced or points_reset.
struct ScanAssemblerCounts {
  std::uint64_t blocks_accepted = 0;
  std::array<std::uint64_t, kBlockRefusals> blocks_refused{};
  std::uint64_t blocks_missing = 0;        // estimated from the gaps between stamps
  std::uint64_t scans = 0;                 // that came out
  std::uint64_t scans_incomplete = 0;      // of these
  std::uint64_t points_in = 0;             // in accepted blocks
  std::uint64_t points_refused = 0;        // in refused blocks
  std::uint64_t points_out = 0;            // in scans that came out
  std::uint64_t points_over_capacity = 0;  // beyond max_points: also Scan::points_dropped
  std::uint64_t points_unplaced = 0;  // in fragments begun and ended inside one block, after a gap
  std::uint64_t points_reset = 0;     // in scans that reset() threw away
  std::uint64_t restarts = 0;         // what was newest was wild, or the clock went back: the scan being filled was thrown away

  std::uint64_t refused_for(BlockRefusal reason) const {
    return blocks_refused[static_cast<std::size_t>(reason)];
  }
};

/// Cuts the blocks of one sensor into scans.
///
/// A scan's points lie in [begin, end), with offset_ns from begin. Scans come out with increasing
/// begin and end; indices count from 0 without gaps.
///
/// kAzimuth: begin is the scan's first firing, end that of the next scan; where packets are missing
/// around the cut, the end of the last packet before it. (While a clock is corrected, stamps of
/// packets may overlap by microseconds; end is then just after the scan's own last point.)
///
/// kPeriod: end is begin + period, and the next scan begins there.
///
/// A scan is incomplete when packets are missing in it, or when it covers less than
/// min_complete_fraction: mostly so the first, which begins wherever the sensor happens to look.
///
/// After a gap of a revolution (a period) or more the scan is closed and the next block begins a
/// new one. kAzimuth closes a scan after kLongestScan at the latest: a sensor that does not turn
/// makes no endless scan.
///
/// A block that leaps ahead by more than kLeap waits until the next one tells a gap from a wild stamp. After blocks that were
/// old for StampGate::kBackSpan the clock has begun anew, as by reset().
///
/// Real-time: allocates in the constructor only (two scans of max_points); one thread.
class ScanAssembler {
 public:
  static constexpr Duration kLongestScan = std::chrono::milliseconds{500};
  static constexpr Duration kLeap = std::chrono::milliseconds{250};  // or two periods, if that is more

  explicit ScanAssembler(const ScanAssemblerConfig& config);

  // A returned scan points into the object.
  ScanAssembler(const ScanAssembler&) = delete;
  ScanAssembler& operator=(const ScanAssembler&) = delete;

  /// Adds a block; returns the scan that it completes, or nullptr. The scan is valid until the next
  /// one completes.
  /// Shapes: the block's points in firing order; kAzimuth needs its sequences, azimuths and offsets
  /// growing, the offsets within block.duration.
  /// Errors: a refused block (see BlockRefusal) is counted and changes nothing else.
  const Scan* add(const PointBlock& block);

  /// Closes the scan being filled, at the end of a recording; nullptr when it holds no block. A block that waits is refused.
  const Scan* flush();

  /// Forgets the scan being filled and the last stamp, so that the clock may begin anew (it went
  /// backward for good). Scan indices go on.
  void reset();

  const ScanAssemblerCounts& counts() const { return counts_; }

 private:
  void forget();
  void refuse(const PointBlock& block, BlockRefusal reason);
  void accept(const PointBlock& block);
  std::optional<BlockRefusal> refusal(const PointBlock& block) const;
  bool malformed(const PointBlock& block) const;
  bool note_gap(const PointBlock& block);
  bool must_close_before(const PointBlock& block) const;
  void add_sequences(const PointBlock& block, bool after_gap);
  void add_by_time(const PointBlock& block, bool after_gap);
  void close_early();
  void close(Stamp end, double fraction);
  void open(Stamp begin, bool after_gap);
  void append(const PointBlock& block, std::size_t first, std::size_t last);
  std::int32_t position_of(std::uint16_t azimuth_cdeg, Stamp time) const;

  Scan& filling() { return scans_[filling_]; }

  const Scan& filling() const { return scans_[filling_]; }

  ScanAssemblerConfig config_;
  std::int32_t cut_azimuth_cdeg_ = 0;

  // The scan being filled.
  std::array<Scan, 2> scans_;  // one is filled, the other is out
  std::size_t filling_ = 0;
  bool open_ = false;
  std::int32_t first_position_cdeg_ = 0;  // of its first firing
  const Scan* completed_ = nullptr;       // by the block in hand

  // The last accepted block. A position is an azimuth counted from the cut angle on: at 36000 comes
  // the next cut.
  bool has_last_ = false;
  Stamp last_begin_{};
  Stamp last_end_{};  // where the next block should begin
  Duration last_duration_{};
  Stamp last_sequence_{};
  std::int32_t position_cdeg_ = 0;  // of the last sequence
  double rate_cdeg_per_ns_ = 0.0;   // of turning, seen in the last block; 0: not known

  StampGate gate_;
  bool has_ahead_ = false;
  PointBlock ahead_;  // a leap that waits

  std::uint64_t next_index_ = 0;
  ScanAssemblerCounts counts_;
};

}  // namespace slamd::sensor
