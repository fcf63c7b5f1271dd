#include "daemon/service/log.hpp"

#include <fcntl.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace slamd::service {

namespace {

/// Tells whether standard error is the journal's: systemd says which file its stream is.
bool is_of_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  unsigned long long device = 0;
  unsigned long long inode = 0;

  struct stat file {};

  return stream != nullptr && std::sscanf(stream, "%llu:%llu", &device, &inode) == 2 &&
         fstat(STDERR_FILENO, &file) == 0 && file.st_dev == device && file.st_ino == inode;
}

int journal_socket() {
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  std::strncpy(to.sun_path, "/run/systemd/journal/socket", sizeof to.sun_path - 1);
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd >= 0 && connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    close(fd);
    return -1;
  }
  return fd;
}

/// As in syslog(3).
const char* priority_of(Level level) {
  switch (level) {
    case Level::kError:
      return "3";
    case Level::kWarning:
      return "4";
    default:
      return "6";
  }
}

spdlog::level::level_enum spdlog_level(Level level) {
  switch (level) {
    case Level::kError:
      return spdlog::level::err;
    case Level::kWarning:
      return spdlog::level::warn;
    default:
      return spdlog::level::info;
  }
}

}  // namespace

std::string journal_entry(Level level, const std::string& message, const Fields& fields) {
  std::string entry;
  const auto add = [&](const char* name, std::string value) {
    std::replace(value.begin(), value.end(), '\n', ' ');
    entry += std::string(name) + '=' + value + '\n';
  };
  add("MESSAGE", message);
  add("PRIORITY", priority_of(level));
  add("SYSLOG_IDENTIFIER", "slamd");
  for (const auto& [name, value] : fields) {
    add(name, value);
  }
  return entry;
}

Log::Log() : journal_(is_of_journal() ? journal_socket() : -1) {
  standard_error_ =
      std::make_shared<spdlog::logger>("slamd", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  standard_error_->set_pattern("%L %v");
  standard_error_->flush_on(spdlog::level::info);
}

Log::~Log() {
  if (journal_ >= 0) {
    close(journal_);
  }
}

void Log::write(Level level, const std::string& message, const Fields& fields) {
  if (journal_ < 0) {
    standard_error_->log(spdlog_level(level), message);
    return;
  }
  if (lost_ > 0 &&
      to_journal(
          Level::kWarning, "the journal did not take " + std::to_string(lost_) + " messages", {})) {
    lost_ = 0;
  }
  lost_ += to_journal(level, message, fields) ? 0 : 1;
}

bool Log::to_journal(Level level, const std::string& message, const Fields& fields) const {
  const std::string entry = journal_entry(level, message, fields);
  if (send(journal_, entry.data(), entry.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0) {
    return true;
  }
  // journald has gone and come back: its socket is another one.
  if (errno == ECONNREFUSED || errno == ENOTCONN) {
    const int fresh = journal_socket();
    if (fresh >= 0) {
      dup3(fresh, journal_, O_CLOEXEC);
      close(fresh);
      return send(journal_, entry.data(), entry.size(), MSG_NOSIGNAL | MSG_DONTWAIT) >= 0;
    }
  }
  return false;
}

}  // namespace slamd::service
