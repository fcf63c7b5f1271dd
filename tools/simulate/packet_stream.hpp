#pragma once

#include <optional>
#include <vector>

#include "tools/simulate/scene.hpp"

namespace slamd::simulate {

/// All packets of a drive in the order in which they are sent: points, positions, the LiDAR's own inertial samples.
/// Points are cast in batches by several threads; the bytes are the same for any number of them.
class PacketStream {
 public:
  enum class Drive { kWhole, kGrowing };

  /// A growing drive has no end: next() gives what is certain by what there is of its motion.
  explicit PacketStream(const Scene& scene, Drive drive = Drive::kWhole);

  /// Gives the next packet; false when there is none, at the end or for now. The packet is valid until the next call.
  bool next(const SentPacket*& packet);

  /// The share of the drive that was cast.
  double progress() const { return static_cast<double>(next_index_) / static_cast<double>(count_); }

 private:
  void cast_batch();
  void prepare_extra();
  void take_in();

  const Scene& scene_;
  Drive drive_;
  std::uint64_t count_;
  std::uint64_t next_index_ = 0;       // of the point packet to be cast
  std::vector<SentPacket> batch_;      // cast and not yet given out, by time from given_ on
  std::size_t given_ = 0;
  std::size_t due_ = 0;                // batch_[given_ … due_) can go: nothing earlier will come
  std::optional<SentPacket> extra_;    // the next packet that holds no points
  std::uint64_t next_position_;
  std::uint64_t imu_index_ = 0;
  std::optional<InertialSensor> own_imu_;
  SentPacket out_;
};

}  // namespace slamd::simulate
