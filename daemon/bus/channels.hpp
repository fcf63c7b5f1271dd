#pragma once

#include <string>
#include <string_view>

namespace slamd::bus {

inline constexpr std::string_view kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";
inline constexpr std::string_view kDefaultPrefix = "SLAMD";

/// Tells whether a prefix is 1 to 40 letters, digits, '_' or '-'.
bool is_prefix(std::string_view prefix);

/// The channels of one daemon.
/// Errors: the constructor throws std::invalid_argument when the prefix is none.
struct Channels {
  explicit Channels(std::string_view prefix);

  std::string pose;
  std::string map_to_odom;
  std::string submap_poses;
  std::string map_delta;
  std::string map_request;
  std::string map_snapshot;
  std::string scan;
  std::string health;
  std::string command;
  std::string reply;
  std::string velocity_command;
  std::string truth;
};

}  // namespace slamd::bus
