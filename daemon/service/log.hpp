#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace spdlog {
class logger;
}

namespace slamd::service {

enum class Level { kInfo, kWarning, kError };

/// What a message is about, beside its words: "SLAMD_THREAD", "odometry". Names: upper case, digits
/// and '_'.
using Fields = std::vector<std::pair<const char*, std::string>>;

/// The daemon's log. As a service it goes to the journal, each message with its fields (journalctl
/// SLAMD_STATE=LOST), and otherwise to standard error, without. A journal that does not take a
/// message, for its disk is slow, is not waited for: the message is lost, and how many were is the
/// first that is said afterwards. Threads: one.
class Log {
 public:
  Log();
  ~Log();
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  void write(Level level, const std::string& message, const Fields& fields = {});

  void info(const std::string& message) { write(Level::kInfo, message); }

  void warn(const std::string& message) { write(Level::kWarning, message); }

 private:
  bool to_journal(Level level, const std::string& message, const Fields& fields) const;

  std::shared_ptr<spdlog::logger> standard_error_;  // where there is no journal
  int journal_ = -1;
  std::uint64_t lost_ = 0;
};

/// Returns the datagram of the journal's native protocol: a line for each field. What would break a
/// line is a space in it.
std::string journal_entry(Level level, const std::string& message, const Fields& fields);

}  // namespace slamd::service
