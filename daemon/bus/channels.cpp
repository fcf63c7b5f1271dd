#include "daemon/bus/channels.hpp"

#include <stdexcept>

namespace slamd::bus {

bool is_prefix(std::string_view prefix) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !prefix.empty() && prefix.size() <= 40 && prefix.find_first_not_of(kAllowed) == std::string_view::npos;
}

Channels::Channels(std::string_view prefix) {
  if (!is_prefix(prefix)) {
    throw std::invalid_argument("channel prefix '" + std::string(prefix) +
                                "': allowed are 1 to 40 letters, digits, '_' and '-'");
  }
  pose = std::string(prefix) + "_POSE";
  map_to_odom = std::string(prefix) + "_MAP_TO_ODOM";
  submap_poses = std::string(prefix) + "_SUBMAP_POSES";
  map_delta = std::string(prefix) + "_MAP_DELTA";
  map_request = std::string(prefix) + "_MAP_REQUEST";
  map_snapshot = std::string(prefix) + "_MAP_SNAPSHOT";
  scan = std::string(prefix) + "_SCAN";
  health = std::string(prefix) + "_HEALTH";
  command = std::string(prefix) + "_COMMAND";
  reply = std::string(prefix) + "_REPLY";
  velocity_command = std::string(prefix) + "_VELOCITY_COMMAND";
  truth = std::string(prefix) + "_TRUTH";
}

}  // namespace slamd::bus
