#include "tools/simulate/packet_stream.hpp"

#include <algorithm>
#include <thread>

namespace slamd::simulate {

namespace {

constexpr std::uint64_t kBatch = 512;
constexpr double kOwnImu_hz = 200.0;
constexpr std::uint64_t kOwnImuSeed = 1'000'003;  // another sensor, other errors
constexpr double kImuLag_s = 1.2e-4;               // from an inertial sample to its packet

}  // namespace

PacketStream::PacketStream(const Scene& scene, Drive drive)
    : scene_(scene), drive_(drive), count_(scene.packets()), next_position_(SpinningLidar::kPositionEvery) {
  const geometry::Se3& T_base_lidar = scene.mounting().T_base_lidar;
  if (scene.spinning() == nullptr) {
    const geometry::Se3 T_lidar_imu = scene.avia() != nullptr ? LivoxLidar::T_lidar_imu() : Mid360Lidar::T_lidar_imu();
    own_imu_.emplace(scene.motion(), T_base_lidar * T_lidar_imu, kOwnImu_hz, scene.drive().imu_errors,
                     scene.drive().seed + kOwnImuSeed);
  }
  prepare_extra();
}

void PacketStream::prepare_extra() {
  extra_.reset();
  if (scene_.spinning() != nullptr) {
    if (next_position_ < count_ || (drive_ == Drive::kGrowing && next_position_ == count_)) {
      extra_ = scene_.spinning()->position_packet(next_position_);
      next_position_ += SpinningLidar::kPositionEvery;
    }
    return;
  }
  if (drive_ == Drive::kGrowing && own_imu_->next_s() > scene_.known_s()) {
    return;
  }
  double t_s = 0.0;
  InertialReading reading;
  if (own_imu_->next(t_s, reading)) {
    extra_ = scene_.avia() != nullptr ? scene_.avia()->imu_packet(t_s, reading)
                                      : scene_.mid360()->imu_packet(t_s, imu_index_, reading);
    ++imu_index_;
  }
}

void PacketStream::cast_batch() {
  batch_.erase(batch_.begin(), batch_.begin() + static_cast<std::ptrdiff_t>(given_));
  given_ = 0;
  const std::size_t kept = batch_.size();
  const std::size_t size = std::min(kBatch, count_ - next_index_);
  batch_.resize(kept + size);
  const auto threads = static_cast<std::size_t>(scene_.drive().threads);
  const auto work = [&](std::size_t worker) {
    for (std::size_t i = worker; i < size; i += threads) {
      batch_[kept + i] = scene_.lidar().packet(next_index_ + i);
    }
  };
  std::vector<std::thread> workers;
  for (std::size_t worker = 1; worker < threads; ++worker) {
    workers.emplace_back(work, worker);
  }
  work(0);
  for (std::thread& worker : workers) {
    worker.join();
  }
  next_index_ += size;
  std::stable_sort(batch_.begin(), batch_.end(),
                   [](const SentPacket& a, const SentPacket& b) { return a.sent_s < b.sent_s; });
  // The next batch's first packet is sent when its last firing is done, at the earliest.
  double earliest_s = static_cast<double>(next_index_ + 1) * scene_.lidar().packet_s();
  if (drive_ == Drive::kGrowing && own_imu_) {
    earliest_s = std::min(earliest_s, scene_.known_s() + kImuLag_s);
  }
  const auto later =
      std::partition_point(batch_.begin(), batch_.end(), [&](const SentPacket& p) { return p.sent_s < earliest_s; });
  const bool all = drive_ == Drive::kWhole && next_index_ == count_;
  due_ = all ? batch_.size() : static_cast<std::size_t>(later - batch_.begin());
}

/// Sees whether the drive has grown.
void PacketStream::take_in() {
  count_ = scene_.packets();
  if (!extra_) {
    prepare_extra();
  }
}

bool PacketStream::next(const SentPacket*& packet) {
  take_in();
  while (given_ == due_ && next_index_ < count_) {
    cast_batch();
  }
  if (given_ == due_) {
    return false;  // extras after the last points are of no use
  }
  if (extra_ && extra_->sent_s <= batch_[given_].sent_s) {
    out_ = std::move(*extra_);
    prepare_extra();
  } else {
    out_ = std::move(batch_[given_++]);
  }
  packet = &out_;
  return true;
}

}  // namespace slamd::simulate
