#pragma once

#include <string>

#include "core/base/stamp.hpp"

namespace slamd::service {

/// Tells the service manager how the service is: sd_notify(3)'s protocol, one datagram to
/// $NOTIFY_SOCKET each. Without a manager everything is without effect. A datagram that finds the
/// manager's queue full is left out: the next one follows soon, and nothing here ever waits.
/// Threads: one.
class Notifier {
 public:
  /// Takes the manager's address and its watchdog ($WATCHDOG_USEC of $WATCHDOG_PID) out of the
  /// environment.
  Notifier();
  ~Notifier();
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;

  /// Whether there is a manager.
  bool is_heard() const { return fd_ >= 0; }

  void ready() { send("READY=1"); }

  void reloading();

  void stopping() { send("STOPPING=1"); }

  void status(const std::string& words) { send("STATUS=" + words); }

  /// Feeds the manager's watchdog: an abort follows `patience()` after the last time.
  void feed() { send("WATCHDOG=1"); }

  /// How long the manager waits to be fed; zero: for ever.
  Duration patience() const { return patience_; }

  /// Has the manager wait for so long from now on, which feeds it once; without effect where it waits so long already, or has
  /// no watchdog.
  void set_patience(Duration patience);

 private:
  void send(const std::string& message);

  int fd_ = -1;
  Duration patience_{};
};

}  // namespace slamd::service
