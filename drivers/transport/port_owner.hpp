#pragma once

#include <cstdint>
#include <string>

namespace slamd::transport {

/// Names the process that has bound a UDP port: "slamd (pid 123)"; empty where that cannot be seen, as for the
/// processes of other users.
/// Real-time: no; reads /proc.
std::string udp_port_owner(std::uint16_t port);

}  // namespace slamd::transport
