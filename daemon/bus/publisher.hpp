#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/bounded_vector.hpp"
#include "core/occupancy/map_delta.hpp"
#include "daemon/bus/channels.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/messages.hpp"
#include "daemon/bus/scan_chunks.hpp"

namespace slamd::bus {

struct PublisherConfig {
  std::string url{kDefaultUrl};
  std::string prefix{kDefaultPrefix};
  std::size_t scan_points = 2000;  // of a scan that are sent, evenly chosen; 0: no scans
};

/// Sends the daemon's messages. Each is encoded into a buffer of its own and published raw.
/// Errors: the constructor throws BusError (no multicast route, bad URL) and std::invalid_argument (prefix).
/// publish() returns whether LCM took the message, and counts it if not; there is nothing else to do about it.
/// Threads: each publish() from one thread at a time; different ones may overlap (LCM has a mutex of its own).
/// Real-time: publish() of pose, map_to_odom, submap_poses and scan does not allocate on udpm; it takes LCM's mutex and sends.
/// Health and the map's messages allocate.
class Publisher {
 public:
  explicit Publisher(const PublisherConfig& config);

  /// Shares a connection, whatever config.url says: memq:// carries messages only inside one.
  Publisher(std::shared_ptr<Connection> connection, const PublisherConfig& config);

  bool publish(const Pose& pose);
  bool publish(const MapToOdom& map_to_odom);
  bool publish(const SubmapPoses& submap_poses);
  bool publish(const Health& health);

  /// Sends what has changed of the map, or an answer to requests for it.
  bool publish(const occupancy::MapDelta& delta, bool is_answer);

  /// Sends the scan in chunks; returns whether all went.
  bool publish(const Scan& scan);

  std::uint64_t messages_sent() const { return sent_.load(std::memory_order_relaxed); }
  std::uint64_t messages_failed() const { return failed_.load(std::memory_order_relaxed); }

 private:
  using Buffer = std::array<std::byte, kLargestMessage_bytes>;

  bool send(const std::string& channel, const Buffer& buffer, std::size_t size);

  Channels channels_;
  std::shared_ptr<Connection> connection_;
  ScanChunker chunker_;
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<std::uint64_t> failed_{0};
  // scratch, sized once: a buffer for each kind, so that kinds need no lock between them
  Buffer pose_buffer_{};
  Buffer map_to_odom_buffer_{};
  Buffer submap_poses_buffer_{};
  Buffer scan_buffer_{};
  Buffer health_buffer_{};
  Buffer map_delta_buffer_{};
};

}  // namespace slamd::bus
