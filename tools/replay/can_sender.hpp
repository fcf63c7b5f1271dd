#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "drivers/recording/candump.hpp"
#include "tools/replay/network_player.hpp"

namespace slamd::replay {

/// A socket that sends frames to a CAN interface.
class CanSender {
 public:
  /// Errors: std::runtime_error: no such interface, none of CAN, a kernel without it.
  explicit CanSender(const std::string& interface);
  ~CanSender();
  CanSender(const CanSender&) = delete;
  CanSender& operator=(const CanSender&) = delete;

  /// Sends a frame, and waits for room as long as the bus is busy. Errors: std::runtime_error when the interface is gone.
  void send(const transport::CanFrame& frame, SendClock& clock);

 private:
  std::string interface_;
  int fd_ = -1;
};

/// The frames of a recording's candump log on their way to a bus, one ahead.
class CanFrames {
 public:
  /// All frames of the log go out, whatever their interface was.
  CanFrames(const std::filesystem::path& file, CanSender& sender, SendClock& clock)
      : reader_(file), sender_(sender), clock_(clock) {
    advance();
  }

  const std::optional<transport::CanFrame>& next() const { return next_; }

  /// Passes over frames that are earlier than a stamp; returns how many.
  std::uint64_t skip_until(Stamp stamp);

  /// Sends each frame up to a stamp when it is due; returns how many, fewer when the user wants no more.
  std::uint64_t send_until(Stamp until, NetworkPlayer& player);

  const recording::CandumpCounters& counters() const { return reader_.counters(); }

 private:
  void advance();

  recording::CandumpReader reader_;
  CanSender& sender_;
  SendClock& clock_;
  std::optional<transport::CanFrame> next_;
};

}  // namespace slamd::replay
