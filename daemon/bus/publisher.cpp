#include "daemon/bus/publisher.hpp"

#include <utility>

#include "daemon/bus/encoding.hpp"
#include "daemon/bus/map_encoding.hpp"

namespace slamd::bus {

Publisher::Publisher(const PublisherConfig& config)
    : Publisher(std::make_shared<Connection>(config.url), config) {}

Publisher::Publisher(std::shared_ptr<Connection> connection, const PublisherConfig& config)
    : channels_(config.prefix), connection_(std::move(connection)), chunker_(config.scan_points) {}

bool Publisher::publish(const Pose& pose) {
  return send(channels_.pose, pose_buffer_, encode(pose, pose_buffer_));
}

bool Publisher::publish(const MapToOdom& map_to_odom) {
  return send(channels_.map_to_odom, map_to_odom_buffer_, encode(map_to_odom, map_to_odom_buffer_));
}

bool Publisher::publish(const SubmapPoses& submap_poses) {
  return send(channels_.submap_poses, submap_poses_buffer_, encode(submap_poses, submap_poses_buffer_));
}

bool Publisher::publish(const Health& health) {
  return send(channels_.health, health_buffer_, encode(health, health_buffer_));
}

bool Publisher::publish(const occupancy::MapDelta& delta, bool is_answer) {
  return send(is_answer ? channels_.map_snapshot : channels_.map_delta, map_delta_buffer_, encode(delta, map_delta_buffer_));
}

bool Publisher::publish(const Scan& scan) {
  const std::size_t chunks = chunker_.begin(scan);
  bool all = true;
  for (std::size_t i = 0; i < chunks; ++i) {
    all = send(channels_.scan, scan_buffer_, encode(chunker_.chunk(i), scan_buffer_)) && all;
  }
  return all;
}

bool Publisher::send(const std::string& channel, const Buffer& buffer, std::size_t size) {
  const bool sent = size > 0 && connection_->send(channel, {buffer.data(), size});
  (sent ? sent_ : failed_).fetch_add(1, std::memory_order_relaxed);
  return sent;
}

}  // namespace slamd::bus
