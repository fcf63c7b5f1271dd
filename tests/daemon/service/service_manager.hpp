#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstring>
#include <string>

namespace slamd::service {

/// The service manager's end of sd_notify(3): an abstract socket that keeps what it is told.
class ServiceManager {
 public:
  ServiceManager()
      : fd_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
        name_("slamd_test_" + std::to_string(getpid())) {
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    std::memcpy(to.sun_path + 1, name_.data(), name_.size());
    bind(fd_,
         reinterpret_cast<const sockaddr*>(&to),
         static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name_.size()));
  }

  ~ServiceManager() { close(fd_); }

  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  std::string address() const { return "@" + name_; }

  /// The next thing told, waited for at most for `longest`; empty: nothing.
  std::string next(std::chrono::milliseconds longest = std::chrono::seconds(10)) {
    pollfd entry{fd_, POLLIN, 0};
    if (poll(&entry, 1, static_cast<int>(longest.count())) <= 0) {
      return {};
    }
    char text[2048];
    const ssize_t size = recv(fd_, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string();
  }

  /// Reads on until something begins with `prefix`, and returns it; empty: it did not come.
  std::string wait_for(const std::string& prefix, std::chrono::milliseconds longest) {
    const auto end = std::chrono::steady_clock::now() + longest;
    for (auto left = longest; left.count() > 0;
         left = std::chrono::duration_cast<std::chrono::milliseconds>(
             end - std::chrono::steady_clock::now())) {
      if (std::string told = next(left); told.starts_with(prefix)) {
        return told;
      }
    }
    return {};
  }

 private:
  int fd_;
  std::string name_;
};

}  // namespace slamd::service
