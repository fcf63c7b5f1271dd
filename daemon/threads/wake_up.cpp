#include "daemon/threads/wake_up.hpp"

#include <cerrno>
#include <cstdint>
#include <ctime>
#include <system_error>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace slamd::threads {

WakeUp::WakeUp() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (fd_ < 0) {
    throw std::system_error(errno, std::generic_category(), "eventfd");
  }
}

WakeUp::~WakeUp() { close(fd_); }

void WakeUp::notify() {
  const std::uint64_t one = 1;
  // Fails only when the counter is full: then the sleeper is awake anyway.
  [[maybe_unused]] const ssize_t written = write(fd_, &one, sizeof one);
}

void WakeUp::wait(Duration longest) {
  pollfd entry{fd_, POLLIN, 0};
  const std::timespec timeout{longest.count() / 1'000'000'000, longest.count() % 1'000'000'000};
  if (ppoll(&entry, 1, &timeout, nullptr) > 0) {
    clear();
  }
}

void WakeUp::clear() {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t taken = read(fd_, &count, sizeof count);
}

}  // namespace slamd::threads
