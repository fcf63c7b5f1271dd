#include "daemon/pipeline/mapping_loop.hpp"

#include <algorithm>

namespace slamd::pipeline {

using threads::Event;

namespace {

constexpr Duration kSubmapsPeriod = std::chrono::seconds(1);

}  // namespace

MappingLoop::MappingLoop(const mapping::MapperConfig& config, const transport::HostClock& clock, Rings& rings, bus::Publisher& publisher)
    : clock_(clock), rings_(rings), publisher_(publisher), stage_(config) {}

void MappingLoop::run_once(Duration longest) {
  rings_.wake_mapping.wait(longest);
  if (auto scan = rings_.to_mapping.try_pop()) {  // one a round: each is a sign of life
    take(*scan);
    if (!rings_.to_mapping.empty()) {
      rings_.wake_mapping.notify();
    }
  }
  send_submaps(clock_.now());
}

void MappingLoop::take(MapScan& scan) {
  const Stamp begin = clock_.now();
  const std::span<const Eigen::Vector3f> points =
      scan.points ? scan.points->view() : std::span<const Eigen::Vector3f>();
  const mapping::MapperUpdate update = stage_.process(scan.scan, points);
  scan.points.reset();
  const mapping::Mapper& mapper = stage_.mapper();
  for (const graph::LoopEvent& event : update.loops) {
    if (event.verdict == graph::LoopVerdict::kTakenOut) {
      events_.write(begin, Event::kLoopRemoved, event.id);
    }
  }
  correct();
  if (const auto submaps = mapper.submaps().view(); !submaps.empty()) {
    rings_.newest_submap.store(stages::NewestSubmap::of(submaps.back().id, submaps.back().anchor_odom, stage_.epoch()));
  }
  submaps_changed_ = submaps_changed_ || update.corrected;
  MappingCounts counts;
  counts.scans = shown_.load().value_or(MappingCounts{}).scans + 1;
  counts.keyframes = mapper.keyframes().size();
  counts.retired = mapper.retired();
  counts.candidates = mapper.counts().candidates;
  counts.verified = mapper.counts().verified();
  counts.accepted = mapper.counts().accepted();
  counts.removed = mapper.counts().removed();
  shown_.store(counts);
  const Stamp end = clock_.now();
  monitor_.add(end - begin, end);
}

void MappingLoop::correct() {
  const mapping::Mapper& mapper = stage_.mapper();
  if (mapper.correction_id() == shown_correction_) {
    return;
  }
  shown_correction_ = mapper.correction_id();
  rings_.correction.store(MapCorrection::of(mapper.T_map_odom(), shown_correction_, stage_.epoch()));
  events_.write(clock_.now(), Event::kMapCorrected, shown_correction_);
  rings_.wake_publish.notify();
}

void MappingLoop::send_submaps(Stamp now) {
  const bool placed = rings_.placement.version() != placement_version_;
  if (!submaps_changed_ && !placed && now - last_submaps_sent_ < kSubmapsPeriod) {
    return;
  }
  placement_version_ = rings_.placement.version();
  submaps_changed_ = false;
  last_submaps_sent_ = now;
  const MapPlacement placement = rings_.placement.load().value_or(MapPlacement{});
  const geometry::Se3 T_map_corrected = placement.T_map_corrected();
  const auto submaps = stage_.mapper().submaps().view();
  constexpr std::size_t kEach = bus::SubmapPoses::kSubmaps;
  bus::SubmapPoses message;
  message.stamp = now;
  message.correction_id = placement.correction_id + shown_correction_;
  message.epoch = stage_.epoch();
  message.count = static_cast<std::uint16_t>(std::max<std::size_t>(1, (submaps.size() + kEach - 1) / kEach));
  for (std::size_t chunk = 0; chunk < message.count; ++chunk) {
    const auto part = submaps.subspan(chunk * kEach, std::min(kEach, submaps.size() - chunk * kEach));
    message.index = static_cast<std::uint16_t>(chunk);
    message.size = part.size();
    for (std::size_t i = 0; i < part.size(); ++i) {
      message.submaps[i] = {part[i].id, part[i].version, part[i].anchor_odom, T_map_corrected * part[i].T_map_submap};
    }
    publisher_.publish(message);
  }
}

}  // namespace slamd::pipeline
