#include "drivers/transport/interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

namespace slamd::transport {

namespace {

std::uint32_t ipv4_of(const sockaddr* address) {
  return ntohl(reinterpret_cast<const sockaddr_in*>(address)->sin_addr.s_addr);
}

}  // namespace

std::vector<Interface> interfaces() {
  std::vector<Interface> found;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) {
    return found;
  }
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    const bool ipv4 = entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET && entry->ifa_netmask != nullptr;
    if (ipv4 && (entry->ifa_flags & IFF_UP) != 0) {
      found.push_back({if_nametoindex(entry->ifa_name), ipv4_of(entry->ifa_addr), ipv4_of(entry->ifa_netmask),
                       (entry->ifa_flags & IFF_BROADCAST) != 0});
    }
  }
  freeifaddrs(list);
  return found;
}

}  // namespace slamd::transport
