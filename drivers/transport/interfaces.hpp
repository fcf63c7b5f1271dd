#pragma once

#include <cstdint>
#include <vector>

namespace slamd::transport {

/// An IPv4 address of this host, on an interface that is up. Addresses in host order.
struct Interface {
  unsigned index = 0;
  std::uint32_t address = 0;
  std::uint32_t netmask = 0;
  bool broadcasts = false;  // loopback does not
};

/// Asks the kernel for all of them.
std::vector<Interface> interfaces();

}  // namespace slamd::transport
