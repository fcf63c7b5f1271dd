#include "tools/replay/sensor_terminal.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace slamd::replay {

namespace fs = std::filesystem;

SensorTerminal::SensorTerminal(const fs::path& link, std::string greeting) : link_(link), greeting_(std::move(greeting)) {
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(link_, ignored)) && !fs::is_symlink(link_)) {
    throw std::runtime_error(link_.string() + ": is there already, and no link");
  }
  char name[64];
  fd_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0 || grantpt(fd_) != 0 || unlockpt(fd_) != 0 || ptsname_r(fd_, name, sizeof name) != 0) {
    const std::error_code error(errno, std::generic_category());
    ::close(fd_);
    throw std::runtime_error("no pseudo terminal to be had: " + error.message());
  }
  name_ = name;
  // Only after its first closing does the kernel tell a terminal that nobody reads.
  ::close(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  std::error_code error;
  make_raw();
  fs::remove(link_, ignored);
  fs::create_symlink(name_, link_, error);
  if (error) {
    ::close(fd_);
    throw std::runtime_error(link_.string() + ": cannot be made: " + error.message());
  }
}

SensorTerminal::~SensorTerminal() {
  std::error_code ignored;
  if (fs::read_symlink(link_, ignored) == name_) {
    fs::remove(link_, ignored);
  }
  ::close(fd_);
}

bool SensorTerminal::has_reader() const {
  pollfd state{fd_, 0, 0};
  return poll(&state, 1, 0) >= 0 && (state.revents & POLLHUP) == 0;
}

bool SensorTerminal::write(std::string_view bytes) {
  if (!has_reader()) {
    heard_ = false;
    return false;
  }
  if (backlog_.size() + bytes.size() > kMaxBacklogBytes) {
    return false;
  }
  if (!heard_) {
    heard_ = true;
    make_raw();
    backlog_ += greeting_;
    taken_bytes_ += greeting_.size();
  }
  backlog_ += bytes;
  taken_bytes_ += bytes.size();
  ends_.push_back(taken_bytes_);
  push();
  return true;
}

std::span<const std::byte> SensorTerminal::read() {
  if (!has_reader()) {
    return {};
  }
  const ssize_t bytes = ::read(fd_, heard_bytes_.data(), heard_bytes_.size());
  return std::span(heard_bytes_).first(static_cast<std::size_t>(std::max<ssize_t>(0, bytes)));
}

void SensorTerminal::make_raw() {
  termios mode{};
  if (tcgetattr(fd_, &mode) == 0) {
    cfmakeraw(&mode);
    tcsetattr(fd_, TCSANOW, &mode);
  }
}

void SensorTerminal::push() {
  while (!backlog_.empty()) {
    const ssize_t written = ::write(fd_, backlog_.data(), backlog_.size());
    if (written <= 0) {
      return;
    }
    backlog_.erase(0, static_cast<std::size_t>(written));
    pushed_bytes_ += static_cast<std::uint64_t>(written);
    while (!ends_.empty() && ends_.front() <= pushed_bytes_) {
      ends_.pop_front();
    }
  }
}

bool SensorTerminal::is_drained() {
  if (!has_reader()) {
    return true;
  }
  push();
  // poll() waits for what the kernel still carries from one side to the other; FIONREAD would not count it.
  pollfd reader{::open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC), POLLIN, 0};
  const bool empty = reader.fd >= 0 && poll(&reader, 1, 0) == 0;
  ::close(reader.fd);
  return backlog_.empty() && empty;
}

}  // namespace slamd::replay
