#include "tools/replay/replay.hpp"

#include <chrono>
#include <ctime>

#include "core/calibration/words.hpp"
#include "daemon/stages/waiting_scan.hpp"
#include "drivers/clouds/point_folder.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "tools/replay/can_log.hpp"

namespace slamd::replay {

using configuration::LidarModel;
using recording::Packet;
using sensor::ImuSample;
using sensor::Scan;
using stages::thread_cpu_ms;

namespace {

/// The inertial samples of a recording or a source, one ahead.
class ImuSource {
 public:
  ImuSource() = default;

  explicit ImuSource(const Recording& recording) {
    if (!recording.imu_can.empty()) {
      can_.emplace(recording.imu_can, recording.configuration);
    } else if (!recording.imu_csv.empty()) {
      reader_.emplace(recording.imu_csv);
    }
    advance();
  }

  explicit ImuSource(PacketSource& source) : source_(&source) { advance(); }

  const std::optional<ImuSample>& next() const { return next_; }

  void advance() {
    ImuSample sample;
    const bool more = source_ != nullptr ? source_->next_imu(sample) : (can_ ? can_->next(sample) : reader_ && reader_->next(sample));
    next_ = more ? std::optional(sample) : std::nullopt;
    samples_ += more ? 1 : 0;
  }

  stages::NamedCounts counts() const {
    stages::NamedCounts counts;
    if (can_) {
      return can_->counts();
    }
    if (reader_) {
      counts.emplace_back("rows", reader_->counters().rows);
      for (std::size_t i = 0; i < recording::kRowRefusals; ++i) {
        const auto refused = reader_->counters().refused[i];
        if (refused != 0) {
          counts.emplace_back(std::string("refused_row_") + name_of(static_cast<recording::RowRefusal>(i)), refused);
        }
      }
      if (reader_->counters().steps_back != 0) {
        counts.emplace_back("steps_back", reader_->counters().steps_back);
      }
    } else if (source_ != nullptr) {
      counts.emplace_back("rows", samples_);
    }
    return counts;
  }

 private:
  std::optional<recording::ImuCsvReader> reader_;
  std::optional<CanLogImu> can_;
  PacketSource* source_ = nullptr;
  std::uint64_t samples_ = 0;
  std::optional<ImuSample> next_;
};

/// The wheels of a recording or a source, one sample ahead.
class WheelFeed {
 public:
  WheelFeed() = default;

  explicit WheelFeed(const Recording& recording) {
    if (!recording.wheel_can.empty()) {
      can_.emplace(recording.wheel_can, recording.configuration);
    } else if (!recording.wheel_csv.empty()) {
      reader_.emplace(recording.wheel_csv);
    }
    advance();
  }

  explicit WheelFeed(PacketSource& source) : source_(&source) { advance(); }

  const std::optional<sensor::WheelSample>& next() const { return next_; }

  void advance() {
    sensor::WheelSample sample;
    const bool more = source_ != nullptr ? source_->next_wheel(sample) : (can_ ? can_->next(sample) : reader_ && reader_->next(sample));
    next_ = more ? std::optional(sample) : std::nullopt;
    samples_ += more ? 1 : 0;
  }

  stages::NamedCounts counts() const {
    if (can_) {
      return can_->counts();
    }
    stages::NamedCounts counts{{"rows", samples_}};
    for (std::size_t i = 0; reader_ && i < recording::kRowRefusals; ++i) {
      if (const auto refused = reader_->counters().refused[i]; refused != 0) {
        counts.emplace_back(std::string("refused_row_") + name_of(static_cast<recording::RowRefusal>(i)), refused);
      }
    }
    return counts;
  }

 private:
  std::optional<recording::WheelCsvReader> reader_;
  std::optional<CanLogWheels> can_;
  PacketSource* source_ = nullptr;
  std::uint64_t samples_ = 0;
  std::optional<sensor::WheelSample> next_;
};

/// The run itself: a virtual clock, the front end, and at most one scan that waits for inertial samples.
class Player {
 public:
  Player(const configuration::Configuration& configuration, ImuSource imu, WheelFeed wheels,
         const Sinks& sinks)
      : sinks_(sinks), config_(resolved_odometry(configuration)), front_end_(config_), imu_(std::move(imu)), wheels_(std::move(wheels)),
        waiting_(configuration.odometry.preprocess.max_points) {}

  /// Lets time pass: samples up to `now` arrive in their order, and a waiting scan goes when it can.
  void advance_to(Stamp now) {
    while (imu_.next() && imu_.next()->stamp <= now) {
      take_wheels(imu_.next()->stamp);
      add_imu(*imu_.next(), imu_.next()->stamp);
      imu_.advance();
    }
    take_wheels(now);
    release(now);
  }

  void add_imu(const ImuSample& sample, Stamp now) {
    front_end_.add_imu(sample);
    release(now);
    go_on_without_scan();
  }

  void add_scan(const Scan& scan, double decode_ms, Stamp now) {
    const auto process_it = [this](const Scan& next, Stamp) { process(next); };
    waiting_.flush(process_it);
    ++run_.scans_seen;
    decode_ms_ = decode_ms;
    waiting_.add(scan, now, [&](const Scan& next) { return front_end_.ready_for(next, now); }, process_it);
  }

  Run finish() {
    while (imu_.next() && waiting_.is_waiting() && imu_.next()->stamp <= waiting_.scan().end + stages::PreprocessStage::kImuPatience) {
      advance_to(imu_.next()->stamp);
    }
    waiting_.flush([this](const Scan& scan, Stamp) { process(scan); });
    run_.imu = imu_.counts();
    const sensor::ImuBufferCounts& imu = front_end_.imu().counts();
    run_.imu.emplace_back("accepted", imu.accepted);
    if (imu.restarts != 0) {
      run_.imu.emplace_back("restarts", imu.restarts);
    }
    for (std::size_t i = 0; i < sensor::kImuRefusals; ++i) {
      if (imu.refused[i] != 0) {
        run_.imu.emplace_back("refused_" + std::string(to_string(static_cast<sensor::ImuRefusal>(i))), imu.refused[i]);
      }
    }
    run_.wheel = wheels_.counts();
    const inertial::WheelUpdate& wheels = front_end_.odometry().wheels();
    if (front_end_.wheels_refused() != 0) {
      run_.wheel.emplace_back("refused_stamp", front_end_.wheels_refused());
    }
    run_.wheel.emplace_back("used", wheels.counts().used);
    run_.wheel.emplace_back("slipped", wheels.counts().slipped);
    run_.alignment = front_end_.alignment();
    run_.agreement = front_end_.odometry().agreement();
    run_.remarks = calibration::complaints(run_.agreement, to_seconds(config_.imu_offset), config_.T_base_imu);
    return std::move(run_);
  }

 private:
  void release(Stamp now) {
    waiting_.release([&](const Scan& scan) { return front_end_.ready_for(scan, now); },
                     [this](const Scan& scan, Stamp) { process(scan); });
  }

  void take_wheels(Stamp until) {
    for (; wheels_.next() && wheels_.next()->stamp <= until; wheels_.advance()) {
      front_end_.add_wheel(*wheels_.next());
      release(wheels_.next()->stamp);
      go_on_without_scan();
    }
  }

  void go_on_without_scan() {
    while (!waiting_.is_waiting()) {
      const auto result = front_end_.go_on_without_scan();
      if (!result) {
        return;
      }
      run_.silent.push_back({result->stamp, result->state, result->cause});
      if (sinks_.silence) {
        sinks_.silence(*result);
      }
    }
  }

  void process(const Scan& scan) {
    const auto result = front_end_.process(scan);
    if (!result) {
      run_.scans_before_start += front_end_.started() ? 0 : 1;  // else it came too late, and counts as dropped
      return;
    }
    run_.scans.push_back({*result, front_end_.times(), decode_ms_});
    if (sinks_.scan) {
      sinks_.scan(run_.scans.back(), front_end_.deskewed(), front_end_.odometry().motion());
    }
  }

  const Sinks& sinks_;
  odometry::OdometryConfig config_;
  stages::FrontEnd front_end_;
  ImuSource imu_;
  WheelFeed wheels_;
  stages::WaitingScan waiting_;
  double decode_ms_ = 0.0;  // of the scan in hand
  Run run_;
};

/// Plays packets that `next(packet)` gives; `share()` is how much of them was given.
template <typename Next, typename Share>
Run play_packets(const configuration::Configuration& configuration, ImuSource imu, WheelFeed wheels, Next&& next, Share&& share,
                 const Sinks& sinks) {
  stages::PacketStage packets(configuration);
  sensor::ScanAssembler assembler(stages::assembler_config(configuration));
  sensor::PointBlock block;
  Player player(configuration, std::move(imu), std::move(wheels), sinks);
  double decode_ms = 0.0;
  std::optional<Stamp> first;
  Stamp now{};
  Packet packet;
  while (next(packet)) {
    first = first.value_or(packet.received);
    now = std::max(now, packet.received);  // the clock does not run backwards for a reordered capture
    player.advance_to(now);
    const double begin_ms = thread_cpu_ms();
    const stages::PacketOutcome outcome = packets.add(packet, block);
    const Scan* scan = outcome.has_block ? assembler.add(block) : nullptr;
    decode_ms += thread_cpu_ms() - begin_ms;
    if (outcome.imu) {
      player.add_imu(*outcome.imu, now);
    }
    if (scan != nullptr) {
      player.add_scan(*scan, decode_ms, now);
      decode_ms = 0.0;
      if (sinks.progress) {
        sinks.progress(share());
      }
    }
  }
  if (const Scan* last = assembler.flush(); last != nullptr) {
    player.advance_to(last->end);
    player.add_scan(*last, decode_ms, last->end);
  }
  Run run = player.finish();
  run.packets = packets.packets();
  run.blocks = stages::named_counts(assembler.counts());
  const std::vector<std::string> remarks = packets.remarks();
  run.remarks.insert(run.remarks.begin(), remarks.begin(), remarks.end());
  if (configuration.gnss.is_velodyne()) {
    run.gnss = gnss_summary(packets.gnss_stage());
  }
  run.clock = packets.clock();
  run.recording_s = first ? to_seconds(now - *first) : 0.0;
  return run;
}

Run replay_packets(const Recording& recording, const Sinks& sinks) {
  recording::PcapReader reader(recording.lidar);
  const double file_bytes = static_cast<double>(std::filesystem::file_size(recording.lidar)) + 1.0;
  double read_bytes = 0.0;
  const auto next = [&](Packet& packet) {
    const bool more = reader.next(packet);
    read_bytes += more ? static_cast<double>(packet.payload.size() + 58) : 0.0;
    return more;
  };
  const auto share = [&] { return read_bytes / file_bytes; };
  Run run = play_packets(recording.configuration, ImuSource(recording), WheelFeed(recording), next, share, sinks);
  for (std::size_t i = 1; i < recording::kFrameKinds; ++i) {
    const auto kind = static_cast<recording::FrameKind>(i);
    if (reader.counters().of(kind) != 0) {
      run.packets.emplace_back(std::string("refused_") + name_of(kind), reader.counters().of(kind));
    }
  }
  if (reader.counters().ended_in_a_record) {
    run.remarks.emplace_back("the capture ends in the middle of a record");
  }
  return run;
}

Run replay_points(const Recording& recording, const Sinks& sinks) {
  const auto& lidar = recording.configuration.lidar;
  clouds::PointFolderReader reader(recording.lidar, {lidar.scans_per_second, lidar.points_have_time});
  Player player(recording.configuration, ImuSource(recording), WheelFeed(recording), sinks);
  Scan scan(recording.configuration.odometry.preprocess.max_points);
  std::optional<Stamp> first;
  Stamp now{};
  double begin_ms = thread_cpu_ms();
  while (reader.next(scan)) {
    first = first.value_or(scan.begin);
    now = std::max(now, scan.end);
    player.advance_to(now);
    player.add_scan(scan, thread_cpu_ms() - begin_ms, now);
    if (sinks.progress) {
      sinks.progress(static_cast<double>(reader.files_read()) / static_cast<double>(reader.files()));
    }
    begin_ms = thread_cpu_ms();
  }
  Run run = player.finish();
  run.packets.emplace_back("clouds", reader.counters().scans);
  for (std::size_t i = 0; i < clouds::kCloudRefusals; ++i) {
    const auto refused = reader.counters().refused[i];
    if (refused != 0) {
      run.packets.emplace_back("refused_" + std::string(clouds::name_of(static_cast<clouds::CloudRefusal>(i))), refused);
    }
  }
  if (!reader.counters().first_refused.empty()) {
    run.remarks.push_back("first refused cloud: " + reader.counters().first_refused);
  }
  run.recording_s = first ? to_seconds(now - *first) : 0.0;
  return run;
}

}  // namespace

Run replay(const Recording& recording, const Sinks& sinks) {
  const auto begin = std::chrono::steady_clock::now();
  Run run = recording.configuration.lidar.model == LidarModel::kPoints ? replay_points(recording, sinks)
                                                                        : replay_packets(recording, sinks);
  if (!recording.gnss.empty()) {
    run.gnss = read_gnss(recording.gnss);
  } else if (const auto& gnss = recording.configuration.gnss; !gnss.source.empty() && !gnss.is_serial() && !gnss.is_velodyne()) {
    run.remarks.push_back("gnss.source = \"" + gnss.source + "\" does not exist: no fixes are counted");
  }
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return run;
}

Run replay(const configuration::Configuration& configuration, PacketSource& source, const Sinks& sinks) {
  const auto begin = std::chrono::steady_clock::now();
  const bool external_imu = configuration.imu.enabled && configuration.imu.source != "livox";
  Run run = play_packets(configuration, external_imu ? ImuSource(source) : ImuSource(),
                         configuration.wheel.use ? WheelFeed(source) : WheelFeed(),
                         [&](Packet& packet) { return source.next(packet); }, [&] { return source.progress(); }, sinks);
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return run;
}

}  // namespace slamd::replay
