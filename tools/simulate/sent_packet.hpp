#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace slamd::simulate {

/// Bytes on the wire and when they leave the sensor's socket. Units: s since the start of the drive.
struct SentPacket {
  double sent_s = 0.0;
  std::uint32_t source_address = 0;  // host order
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::vector<std::byte> payload;
};

/// A LiDAR whose packets can be made in any order, by any number of threads.
class PacketMaker {
 public:
  virtual ~PacketMaker() = default;

  /// Makes point packet number `index`; thread-safe, and the same whatever was made before.
  virtual SentPacket packet(std::uint64_t index) const = 0;

  virtual double packet_s() const = 0;       // time between packets
  virtual std::uint64_t shots() const = 0;   // in each packet

  /// Where shot number `shot` of those fired from `t_s` on looks.  Frames: unit vector in lidar.
  virtual Eigen::Vector3d beam(double t_s, std::uint64_t shot) const = 0;

  /// Shots in a second.
  double rate_hz() const { return static_cast<double>(shots()) / packet_s(); }
};

}  // namespace slamd::simulate
