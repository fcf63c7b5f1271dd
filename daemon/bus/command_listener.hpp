#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "daemon/bus/channels.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/messages.hpp"
#include "daemon/bus/rate_limit.hpp"

namespace slamd::bus {

/// What became of the commands that came; for health.
struct CommandCounters {
  std::uint64_t accepted = 0;
  std::uint64_t malformed = 0;  // no command_t, or larger than a message may be
  std::uint64_t refused = 0;    // unknown verb or bad arguments: answered by the listener itself
  std::uint64_t repeated = 0;   // an id that was taken already: answered as before, or still being worked on
  std::uint64_t limited = 0;    // more than kBurst at once or kPerSecond on average: not answered
};

/// Takes commands from the bus and answers them. A command that is repeated (clients repeat themselves until they are
/// answered) is handed on once only.
/// Errors: the constructor throws BusError and std::invalid_argument (prefix).
/// Threads: one. Real-time: no; for the housekeeping thread.
class CommandListener {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kBurst = 10;
  static constexpr int kPerSecond = 5;

  CommandListener(const std::string& url, const std::string& prefix);

  /// Shares a connection, for example a Publisher's; nobody else may then wait() on it.
  CommandListener(std::shared_ptr<Connection> connection, const std::string& prefix);

  CommandListener(const CommandListener&) = delete;
  CommandListener& operator=(const CommandListener&) = delete;

  /// Becomes readable when poll() has something to do.
  int fd() const { return connection_->fd(); }

  /// Returns the next valid command that is there, without waiting; answer it, sooner or later, by answer().
  std::optional<Command> poll(Clock::time_point now);

  /// Sends the reply, and keeps it for when the command is repeated.
  void answer(const Reply& reply);

  const CommandCounters& counters() const { return counters_; }

 private:
  struct Known {
    std::uint64_t id = 0;
    std::optional<Reply> reply;
  };

  void take(std::span<const std::byte> message);
  void send(const Reply& reply);

  Channels channels_;
  std::shared_ptr<Connection> connection_;
  CommandCounters counters_;
  std::optional<Command> taken_;
  std::array<std::optional<Known>, 16> known_;  // the newest ids, round and round
  std::size_t next_known_ = 0;
  Clock::time_point now_{};
  RateLimit limit_{kBurst, kPerSecond};
};

}  // namespace slamd::bus
