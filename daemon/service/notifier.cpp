#include "daemon/service/notifier.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace slamd::service {

namespace {

/// A socket that is connected to the address, a path or '@' and an abstract name; -1: there is
/// none, or nobody hears.
int connected(const char* address) {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  const std::size_t length = address == nullptr ? 0 : std::strlen(address);
  if (length < 2 || length >= sizeof to.sun_path || (address[0] != '/' && address[0] != '@')) {
    return -1;
  }
  std::memcpy(to.sun_path, address, length);
  if (to.sun_path[0] == '@') {
    to.sun_path[0] = '\0';
  }
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
  if (fd >= 0 && connect(fd, reinterpret_cast<const sockaddr*>(&to), size) != 0) {
    close(fd);
    return -1;
  }
  return fd;
}

Duration watchdog_of_environment() {
  const char* usec = std::getenv("WATCHDOG_USEC");
  const char* pid = std::getenv("WATCHDOG_PID");
  if (usec == nullptr || (pid != nullptr && std::strtol(pid, nullptr, 10) != getpid())) {
    return {};
  }
  return std::chrono::microseconds(std::strtoll(usec, nullptr, 10));
}

}  // namespace

Notifier::Notifier()
    : fd_(connected(std::getenv("NOTIFY_SOCKET"))),
      patience_(fd_ >= 0 ? watchdog_of_environment() : Duration{}) {}

Notifier::~Notifier() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

void Notifier::reloading() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t usec = std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1000;
  send("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(usec));
}

void Notifier::set_patience(Duration patience) {
  if (patience_ != Duration::zero() && patience != patience_) {
    patience_ = patience;
    send("WATCHDOG_USEC=" +
         std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(patience).count()));
  }
}

void Notifier::send(const std::string& message) {
  if (fd_ >= 0) {
    [[maybe_unused]] const ssize_t sent =
        ::send(fd_, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }
}

}  // namespace slamd::service
