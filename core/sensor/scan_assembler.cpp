#include "core/sensor/scan_assembler.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"

namespace slamd::sensor {

namespace {

constexpr std::int32_t kRevolution_cdeg = 36000;

std::int32_t wrapped_cdeg(std::int32_t angle_cdeg) {
  const std::int32_t rest = angle_cdeg % kRevolution_cdeg;
  return rest < 0 ? rest + kRevolution_cdeg : rest;
}

std::int32_t cdeg_from_deg(double angle_deg) {
  return wrapped_cdeg(static_cast<std::int32_t>(std::lround(std::fmod(angle_deg, 360.0) * 100.0)));
}

}  // namespace

std::string_view to_string(BlockRefusal reason) {
  switch (reason) {
    case BlockRefusal::kDuplicate:
      return "duplicate";
    case BlockRefusal::kLate:
      return "late";
    case BlockRefusal::kBackward:
      return "backward";
    case BlockRefusal::kMalformed:
      return "malformed";
    case BlockRefusal::kFarAhead:
      return "far_ahead";
  }
  return "unknown";
}

ScanAssembler::ScanAssembler(const ScanAssemblerConfig& config)
    : config_(config),
      cut_azimuth_cdeg_(cdeg_from_deg(config.cut_azimuth_deg)),
      scans_{Scan(config.max_points), Scan(config.max_points)},
      gate_(std::max(kLeap, 2 * config.period)) {
  SLAMD_ASSERT(config.period > Duration::zero() && config.period <= std::chrono::seconds{4});
  SLAMD_ASSERT(config.max_points > 0);
}

const Scan* ScanAssembler::add(const PointBlock& block) {
  completed_ = nullptr;
  if (malformed(block)) {
    refuse(block, BlockRefusal::kMalformed);
    return nullptr;
  }
  const StampVerdict verdict = gate_.judge(block.stamp);
  const bool ahead_was_wild = verdict == StampVerdict::kSteppedBack || (verdict == StampVerdict::kInOrder && block.stamp <= ahead_.stamp);
  if (verdict == StampVerdict::kAhead) {
    if (has_ahead_) {
      refuse(ahead_, block.stamp == ahead_.stamp ? BlockRefusal::kDuplicate : BlockRefusal::kFarAhead);
    }
    has_ahead_ = true;
    ahead_ = block;
    return nullptr;
  }
  if (has_ahead_ && verdict != StampVerdict::kOld) {
    has_ahead_ = false;
    if (ahead_was_wild) {
      refuse(ahead_, BlockRefusal::kFarAhead);
    } else {
      accept(ahead_);
    }
  }
  if (verdict == StampVerdict::kSteppedBack) {
    forget();
    ++counts_.restarts;
  }
  if (const auto reason = refusal(block)) {
    refuse(block, *reason);
  } else {
    accept(block);
  }
  return completed_;
}

void ScanAssembler::refuse(const PointBlock& block, BlockRefusal reason) {
  ++counts_.blocks_refused[static_cast<std::size_t>(reason)];
  counts_.points_refused += block.points.size();
}

void ScanAssembler::accept(const PointBlock& block) {
  ++counts_.blocks_accepted;
  counts_.points_in += block.points.size();
  const bool after_gap = note_gap(block);
  if (open_ && must_close_before(block)) {
    close_early();
  }
  if (config_.rule == CutRule::kAzimuth) {
    add_sequences(block, after_gap);
  } else {
    add_by_time(block, after_gap);
  }

  has_last_ = true;
  last_begin_ = block.stamp;
  last_end_ = block.stamp + block.duration;
  last_duration_ = block.duration;
}

const Scan* ScanAssembler::flush() {
  completed_ = nullptr;
  if (has_ahead_) {
    has_ahead_ = false;
    refuse(ahead_, BlockRefusal::kFarAhead);
  }
  if (open_) {
    close_early();
  }
  return completed_;
}

void ScanAssembler::reset() {
  forget();
  gate_ = StampGate(std::max(kLeap, 2 * config_.period));
}

void ScanAssembler::forget() {
  if (has_ahead_) {
    has_ahead_ = false;
    refuse(ahead_, BlockRefusal::kFarAhead);
  }
  if (open_) {
    counts_.points_reset += filling().points.size();
  }
  open_ = false;
  has_last_ = false;
  rate_cdeg_per_ns_ = 0.0;
}

std::optional<BlockRefusal> ScanAssembler::refusal(const PointBlock& block) const {
  if (!has_last_) {
    return std::nullopt;
  }
  if (block.stamp == last_begin_) {
    return BlockRefusal::kDuplicate;
  }
  if (block.stamp < last_begin_ - config_.period) {
    return BlockRefusal::kBackward;
  }
  if (block.stamp < last_begin_ + last_duration_ / 2) {
    return BlockRefusal::kLate;
  }
  return std::nullopt;
}

bool ScanAssembler::malformed(const PointBlock& block) const {
  const Duration longest = config_.rule == CutRule::kAzimuth ? kLongestScan : config_.period;
  if (block.duration <= Duration::zero() || block.duration > longest) {
    return true;
  }
  if (!block.points.empty() && Duration{block.points.back().offset_ns} >= block.duration) {
    return true;
  }
  if (config_.rule == CutRule::kPeriod) {
    return false;
  }
  if (block.sequences.empty() || block.sequences[0].first_point != 0) {
    return true;
  }
  std::size_t first_point = 0;
  std::int64_t earlier_ns = -1;
  for (const Sequence& sequence : block.sequences) {
    if (sequence.azimuth_cdeg >= kRevolution_cdeg || sequence.first_point < first_point ||
        sequence.first_point > block.points.size() || sequence.offset_ns <= earlier_ns ||
        Duration{sequence.offset_ns} >= block.duration) {
      return true;
    }
    first_point = sequence.first_point;
    earlier_ns = sequence.offset_ns;
  }
  return false;
}

// Returns whether packets are missing between the last block and this one, and counts them.
bool ScanAssembler::note_gap(const PointBlock& block) {
  const Duration step = block.stamp - last_begin_;
  if (!has_last_ || 2 * step <= 3 * last_duration_) {
    return false;
  }
  counts_.blocks_missing +=
      static_cast<std::uint64_t>((step + last_duration_ / 2) / last_duration_ - 1);
  if (open_) {
    filling().complete = false;
  }
  return true;
}

bool ScanAssembler::must_close_before(const PointBlock& block) const {
  const Duration step = block.stamp - last_begin_;
  if (config_.rule == CutRule::kPeriod) {
    return step > config_.period;
  }
  if (block.stamp + block.duration - filling().begin > kLongestScan) {
    return true;
  }
  return rate_cdeg_per_ns_ > 0.0
             ? static_cast<double>(step.count()) * rate_cdeg_per_ns_ >= kRevolution_cdeg
             : step > config_.period;
}

void ScanAssembler::add_sequences(const PointBlock& block, bool after_gap) {
  const auto count = static_cast<std::int64_t>(block.sequences.size());
  std::int32_t travel_cdeg = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto s = static_cast<std::size_t>(i);
    const Sequence& sequence = block.sequences[s];
    const Stamp time = block.stamp + Duration{sequence.offset_ns};
    const std::int32_t position = position_of(sequence.azimuth_cdeg, time);
    travel_cdeg += i > 0 ? position - position_cdeg_ : 0;
    position_cdeg_ = position;
    last_sequence_ = time;
    if (open_ && position >= kRevolution_cdeg) {
      const bool missing_here = after_gap && i == 0;
      close(missing_here ? last_end_ : time,
            static_cast<double>(kRevolution_cdeg - first_position_cdeg_) / kRevolution_cdeg);
      position_cdeg_ = wrapped_cdeg(position);
      open(time, missing_here);
    } else if (!open_) {
      open(time, false);
    }
    append(block,
           sequence.first_point,
           i + 1 < count ? block.sequences[s + 1].first_point : block.points.size());
  }
  if (count > 1) {
    const auto& sequences = block.sequences;
    const double span_ns = sequences[sequences.size() - 1].offset_ns - sequences[0].offset_ns;
    rate_cdeg_per_ns_ = std::max(0.0, static_cast<double>(travel_cdeg) / span_ns);
  }
}

void ScanAssembler::add_by_time(const PointBlock& block, bool after_gap) {
  if (!open_) {
    open(block.stamp, false);
  }
  if (block.stamp >= filling().end) {
    const Stamp cut = filling().end;
    close(cut, 1.0);
    open(cut, after_gap);
  }
  std::size_t first = 0;
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const Stamp end = filling().end;
    if (block.stamp + Duration{block.points[i].offset_ns} >= end) {
      append(block, first, i);
      first = i;
      close(end, 1.0);
      open(end, false);
    }
  }
  append(block, first, block.points.size());
}

// Closes the scan being filled where its data end: at a gap, or at the end of the recording.
void ScanAssembler::close_early() {
  if (config_.rule == CutRule::kAzimuth) {
    close(last_end_, static_cast<double>(position_cdeg_ - first_position_cdeg_) / kRevolution_cdeg);
  } else {
    close(filling().end, to_seconds(last_end_ - filling().begin) / to_seconds(config_.period));
  }
}

void ScanAssembler::close(Stamp end, double fraction) {
  open_ = false;
  Scan& scan = filling();
  if (completed_ != nullptr) {
    // After a gap: begun and ended inside the block in hand, which has completed a scan already.
    counts_.points_unplaced += scan.points.size();
    return;
  }
  scan.end = end;
  if (!scan.points.empty()) {
    scan.end = std::max(end, scan.begin + Duration{scan.points.back().offset_ns + 1});
  }
  scan.complete = scan.complete && fraction >= config_.min_complete_fraction;
  scan.index = next_index_++;
  ++counts_.scans;
  counts_.scans_incomplete += scan.complete ? 0 : 1;
  counts_.points_out += scan.points.size();
  completed_ = &scan;
  filling_ = 1 - filling_;
}

void ScanAssembler::open(Stamp begin, bool after_gap) {
  open_ = true;
  first_position_cdeg_ = position_cdeg_;
  Scan& scan = filling();
  scan.begin = begin;
  scan.end = begin + config_.period;
  scan.complete = !after_gap;
  scan.points_dropped = 0;
  scan.points.clear();
}

void ScanAssembler::append(const PointBlock& block, std::size_t first, std::size_t last) {
  Scan& scan = filling();
  const Duration shift = block.stamp - scan.begin;
  const std::size_t room = scan.points.capacity() - scan.points.size();
  const std::size_t fitting = std::min(last - first, room);
  for (std::size_t i = first; i < first + fitting; ++i) {
    Point point = block.points[i];
    const Duration offset = shift + Duration{point.offset_ns};
    point.offset_ns = static_cast<std::uint32_t>(std::max(offset, Duration::zero()).count());
    scan.points.push_back(point);
  }
  const std::size_t over = last - first - fitting;
  scan.points_dropped += static_cast<std::uint32_t>(over);
  counts_.points_over_capacity += over;
}

// The azimuth counted from the cut angle on, and on past 36000 until the scan is cut. Of the angles
// that look the same, it is the one nearest to where the sensor should have turned since the last
// sequence.
std::int32_t ScanAssembler::position_of(std::uint16_t azimuth_cdeg, Stamp time) const {
  const std::int32_t from_cut_cdeg = wrapped_cdeg(azimuth_cdeg - cut_azimuth_cdeg_);
  if (!open_) {
    return from_cut_cdeg;
  }
  const double expected_cdeg =
      position_cdeg_ + rate_cdeg_per_ns_ * static_cast<double>((time - last_sequence_).count());
  const double turns = std::round((expected_cdeg - from_cut_cdeg) / kRevolution_cdeg);
  return from_cut_cdeg + static_cast<std::int32_t>(turns) * kRevolution_cdeg;
}

}  // namespace slamd::sensor
