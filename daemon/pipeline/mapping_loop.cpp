#include "daemon/pipeline/mapping_loop.hpp"

#include <algorithm>
#include <exception>

#include "drivers/storage/ply_writer.hpp"

namespace slamd::pipeline {

using threads::Event;

namespace {

constexpr Duration kSubmapsPeriod = std::chrono::seconds(1);

}  // namespace

storage::SessionKeeping session_keeping(const configuration::Configuration& configuration) {
  storage::SessionKeeping keeping;
  keeping.folder = configuration.mapping.session_directory;
  keeping.quota_bytes = static_cast<std::uint64_t>(configuration.mapping.session_quota_mb) * 1'000'000U;
  keeping.sessions = static_cast<std::size_t>(configuration.mapping.sessions);
  keeping.sensor = configuration::name_of(configuration.lidar.model);
  keeping.software = "slamd";
  return keeping;
}

MappingLoop::MappingLoop(const mapping::MapperConfig& config, const storage::SessionKeeping& keeping, const transport::HostClock& clock,
                         Rings& rings, bus::Publisher& publisher)
    : clock_(clock), rings_(rings), publisher_(publisher), stage_(config), keeper_(keeping) {}

void MappingLoop::run_once(Duration longest) {
  rings_.wake_mapping.wait(longest);
  if (auto scan = rings_.to_mapping.try_pop()) {  // one a round: each is a sign of life
    take(*scan);
    if (!rings_.to_mapping.empty()) {
      rings_.wake_mapping.notify();
    }
  }
  keep_session();
  if (const auto wanted = corrected_map_.wanted(stage_.epoch())) {
    write_map(*wanted);
  }
  send_submaps(clock_.now());
}

void MappingLoop::finish() {
  note(stage_.finish());
  keeper_.close();
}

void MappingLoop::take(MapScan& scan) {
  const Stamp begin = clock_.now();
  const std::span<const Eigen::Vector3f> points =
      scan.points ? scan.points->view() : std::span<const Eigen::Vector3f>();
  if (scan.scan.epoch != stage_.epoch()) {
    keeper_.close();  // the next keyframe is of another map
  }
  const mapping::MapperUpdate update = stage_.process(scan.scan, points);
  scan.points.reset();
  ++scans_;
  note(update);
  correct();
  if (const auto submaps = stage_.mapper().submaps().view(); !submaps.empty()) {
    rings_.newest_submap.store(stages::NewestSubmap::of(submaps.back().id, submaps.back().anchor_odom, stage_.epoch()));
  }
  submaps_changed_ = submaps_changed_ || update.corrected;
  const Stamp end = clock_.now();
  monitor_.add(end - begin, end);
}

void MappingLoop::note(const mapping::MapperUpdate& update) {
  const mapping::Mapper& mapper = stage_.mapper();
  const Stamp now = clock_.now();
  for (const graph::LoopEvent& event : update.loops) {
    if (event.verdict == graph::LoopVerdict::kTakenOut) {
      events_.write(now, Event::kLoopRemoved, event.id);
    }
  }
  keeper_.note(mapper, update, now);
  MappingCounts counts = shown_.load().value_or(MappingCounts{});
  counts.scans = scans_;
  counts.keyframes = mapper.keyframes().size();
  counts.retired = mapper.retired();
  counts.candidates = mapper.counts().candidates;
  counts.verified = mapper.counts().verified();
  counts.accepted = mapper.counts().accepted();
  counts.removed = mapper.counts().removed();
  shown_.store(counts);
}

/// Does what is due for the session, and tells what has become of it.
void MappingLoop::keep_session() {
  if (!keeper_.is_on()) {
    return;
  }
  const Stamp now = clock_.now();
  keeper_.attend(stage_.mapper(), now);
  const bool has_fault = !keeper_.fault().empty();
  // Where the map begins anew there is no session and no fault for a while: nothing is written again yet.
  if (has_fault != told_fault_ && (has_fault || !keeper_.session().empty())) {
    told_fault_ = has_fault;
    events_.write(now, has_fault ? Event::kSessionFault : Event::kSessionGoesOn);
  }
  if (keeper_.session() != told_session_) {
    told_session_ = keeper_.session();
    if (!told_session_.empty()) {
      events_.write(now, Event::kSessionBegun, static_cast<std::uint64_t>(keeper_.begun().time_since_epoch() / std::chrono::seconds(1)));
    }
  }
  MappingCounts counts = shown_.load().value_or(MappingCounts{});
  const std::size_t reason = keeper_.fault().find(": ");  // behind the file's name, which health has no room for
  counts.session_bytes = keeper_.bytes();
  counts.session_fault = std::string_view(keeper_.fault()).substr(reason == std::string::npos ? 0 : reason + 2);
  shown_.store(counts);
}

/// Writes all clouds where the corrected poses have them.
void MappingLoop::write_map(const CorrectedMapRequest::Wanted& wanted) {
  const mapping::Mapper& mapper = stage_.mapper();
  const mapping::KeyframeStore& keyframes = mapper.keyframes();
  CorrectedMap map;
  map.epoch = stage_.epoch();
  map.path = mapper.path();
  try {
    storage::PlyWriter file(wanted.ply);
    BoundedVector<Eigen::Vector3f> cloud(keyframes.points_a_cloud());
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      cloud.clear();
      const geometry::Se3 T_base_level(keyframes[i].R_base_level, Eigen::Vector3d::Zero());
      keyframes.append_cloud(i, wanted.T_map_corrected * mapper.T_map_base(i) * T_base_level, cloud);
      for (const Eigen::Vector3f& p_map : cloud) {
        file.write(p_map);
      }
    }
    file.close();
    map.points = file.points();
  } catch (const std::exception& error) {
    map.fault = error.what();
  }
  corrected_map_.give(std::move(map));
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
