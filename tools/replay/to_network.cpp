#include "tools/replay/to_network.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "tools/replay/can_sender.hpp"

namespace slamd::replay {

using configuration::LidarModel;
using recording::Packet;
using sensor::ImuSample;

namespace {

/// The rows of a recording's inertial file, one ahead.
class Rows {
 public:
  Rows() = default;
  explicit Rows(const std::filesystem::path& file) : reader_(std::in_place, file) { advance(); }

  const std::optional<ImuSample>& next() const { return next_; }

  void advance() {
    ImuSample sample;
    next_ = reader_->next(sample) ? std::optional(sample) : std::nullopt;
  }

  /// Passes over rows that are earlier than a stamp; returns how many.
  std::uint64_t skip_until(Stamp stamp) {
    std::uint64_t count = 0;
    for (; next_ && next_->stamp < stamp; advance()) {
      ++count;
    }
    return count;
  }

  void send_until(Stamp until, NetworkPlayer& player) {
    while (next_ && next_->stamp <= until && player.send(*next_, next_->stamp)) {
      advance();
    }
  }

  std::uint64_t refused() const {
    std::uint64_t sum = 0;
    if (reader_) {
      for (const std::uint64_t refused : reader_->counters().refused) {
        sum += refused;
      }
    }
    return sum;
  }

 private:
  std::optional<recording::ImuCsvReader> reader_;
  std::optional<ImuSample> next_;
};

/// The fixes of a recording's gnss.csv, one ahead.
class Fixes {
 public:
  Fixes() = default;
  explicit Fixes(const std::filesystem::path& file) : reader_(std::in_place, file) { advance(); }

  /// Those from before the first packet are left out: their receiver was not there yet.
  void skip_until(Stamp stamp) {
    while (next_ && next_->stamp < stamp) {
      advance();
    }
  }

  void send_until(Stamp until, NetworkPlayer& player) {
    while (next_ && next_->stamp <= until && player.send(*next_, next_->stamp)) {
      advance();
    }
  }

 private:
  void advance() {
    sensor::GnssFix fix;
    next_ = reader_->next(fix) ? std::optional(fix) : std::nullopt;
  }

  std::optional<recording::GnssCsvReader> reader_;
  std::optional<sensor::GnssFix> next_;
};

/// The frames of a recording's candump logs on their way to a bus.
class Bus {
 public:
  Bus(const Recording& recording, const std::string& interface, SendClock& clock) {
    if (interface.empty()) {
      return;
    }
    sender_ = std::make_unique<CanSender>(interface);
    for (const std::filesystem::path& file : {recording.imu_can, recording.wheel_can == recording.imu_can ? "" : recording.wheel_can}) {
      if (!file.empty()) {
        logs_.push_back(std::make_unique<CanFrames>(file, *sender_, clock));
      }
    }
  }

  std::optional<Stamp> first() const {
    std::optional<Stamp> first;
    for (const auto& log : logs_) {
      if (log->next() && (!first || log->next()->received < *first)) {
        first = log->next()->received;
      }
    }
    return first;
  }

  void send_until(Stamp until, NetworkPlayer& player) {
    for (const auto& log : logs_) {
      sent_ += log->send_until(until, player);
    }
  }

  std::uint64_t skip_until(Stamp stamp) {
    std::uint64_t count = 0;
    for (const auto& log : logs_) {
      count += log->skip_until(stamp);
    }
    return count;
  }

  std::uint64_t sent() const { return sent_; }

  std::uint64_t refused() const {
    std::uint64_t sum = 0;
    for (const auto& log : logs_) {
      sum += log->counters().other + log->counters().malformed;
    }
    return sum;
  }

 private:
  std::unique_ptr<CanSender> sender_;
  std::vector<std::unique_ptr<CanFrames>> logs_;
  std::uint64_t sent_ = 0;
};

/// The rate of a recording's inertial file, from its first second.
int rate_of(const std::filesystem::path& file) {
  recording::ImuCsvReader reader(file);
  ImuSample first;
  ImuSample sample;
  int periods = 0;
  if (!reader.next(first)) {
    return 1;
  }
  while (reader.next(sample)) {
    ++periods;
    if (sample.stamp - first.stamp >= std::chrono::seconds(1)) {
      break;
    }
  }
  return periods == 0 ? 1 : std::max(1, static_cast<int>(std::lround(periods / to_seconds(sample.stamp - first.stamp))));
}

}  // namespace

ToNetworkReport send_to_network(const Recording& recording,
                                const ToNetworkOptions& wanted,
                                SendClock& clock,
                                const std::function<bool()>& stopped,
                                const std::function<void(double share)>& progress) {
  if (recording.configuration.lidar.model == LidarModel::kPoints) {
    throw recording::RecordingError(recording.lidar, "is a folder of clouds, which has no packets to send");
  }
  recording::PcapReader reader(recording.lidar);
  ToNetworkOptions options = wanted;
  if (options.imu_protocol != imu::Protocol::kCsv && !recording.imu_csv.empty()) {  // rows need no rate
    options.imu_rate_hz = rate_of(recording.imu_csv);
  }
  NetworkPlayer player(recording.configuration.lidar, options, clock, stopped);
  Bus bus(recording, options.can_interface, clock);
  Rows rows = player.takes_rows() && !recording.imu_csv.empty() ? Rows(recording.imu_csv) : Rows();
  Fixes fixes = player.takes_fixes() && !recording.gnss.empty() ? Fixes(recording.gnss) : Fixes();
  const double file_bytes = static_cast<double>(std::filesystem::file_size(recording.lidar)) + 1.0;
  double read_bytes = 0.0;
  std::uint64_t rows_outside = 0;
  std::uint64_t frames_outside = 0;
  bool begun = false;
  Packet packet;
  while (!player.interrupted() && reader.next(packet)) {
    if (!begun) {
      player.wait_for_reader();
      rows_outside += rows.skip_until(packet.received - kImuMargin);
      fixes.skip_until(packet.received);
      frames_outside += bus.skip_until(packet.received - kImuMargin);
      const Stamp first_row = rows.next() ? rows.next()->stamp : packet.received;
      player.begin(std::min({first_row, bus.first().value_or(packet.received), packet.received}));
      begun = true;
    }
    const Stamp until = std::max(player.now(), packet.received);
    rows.send_until(until, player);
    bus.send_until(until, player);
    fixes.send_until(player.now(), player);
    player.send(packet);
    read_bytes += static_cast<double>(packet.payload.size() + 58);
    if (progress) {
      progress(read_bytes / file_bytes);
    }
  }
  if (!begun) {
    throw recording::RecordingError(recording.lidar, "holds no packet");
  }
  const Stamp end = player.now() + kImuMargin;
  rows.send_until(end, player);
  bus.send_until(end, player);
  ToNetworkReport report = player.finish();
  report.imu_outside = rows_outside + (report.interrupted ? 0 : rows.skip_until(Stamp::max()));
  report.can_frames = bus.sent();
  report.can_outside = frames_outside + (report.interrupted ? 0 : bus.skip_until(Stamp::max()));
  report.can_refused = bus.refused();
  for (std::size_t i = 1; i < recording::kFrameKinds; ++i) {
    report.foreign += reader.counters().of(static_cast<recording::FrameKind>(i));
  }
  report.imu_refused = rows.refused();
  return report;
}

}  // namespace slamd::replay
