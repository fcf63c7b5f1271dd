#include "tools/bench/own_network.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <arpa/inet.h>
#include <net/if.h>
#include <net/route.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace slamd::bench {

namespace {

sockaddr address(const char* dotted) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  inet_pton(AF_INET, dotted, &in.sin_addr);
  sockaddr result{};
  std::memcpy(&result, &in, sizeof result);
  return result;
}

}  // namespace

bool enter_own_network() {
  if (unshare(CLONE_NEWNET) != 0) {
    return false;
  }
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  char loopback[] = "lo";
  ifreq interface {};
  std::strcpy(interface.ifr_name, loopback);
  interface.ifr_flags = IFF_UP;
  rtentry route{};
  route.rt_dst = address("224.0.0.0");
  route.rt_genmask = address("240.0.0.0");
  route.rt_flags = RTF_UP;
  route.rt_dev = loopback;
  const bool good = ioctl(fd, SIOCSIFFLAGS, &interface) == 0 && ioctl(fd, SIOCADDRT, &route) == 0;
  const int error = errno;
  close(fd);
  if (!good) {
    throw std::system_error(error, std::generic_category(), "loopback of a network namespace");
  }
  return true;
}

}  // namespace slamd::bench
