#pragma once

#include <deque>
#include <string>

#include "tools/replay/can_sender.hpp"
#include "tools/simulate/can_log.hpp"

namespace slamd::simulate {

/// The sensors of a live drive on a CAN bus: what they measure goes out as frames, each at its time.
class LiveCan {
 public:
  /// Errors: std::runtime_error for an interface that cannot be had.
  LiveCan(const Drive& drive, const std::string& interface, replay::SendClock& clock)
      : clock_(clock), sender_(interface), imu_(*drive.can), wheels_(wheel_signals(drive.wheel_errors.track_m)) {}

  /// Takes what a sensor has measured.
  void add(const sensor::ImuSample& sample);
  void add(const WheelReading& reading, Stamp stamp) { insert(wheel_frame(wheels_, reading, stamp)); }

  /// Sends the frames that are due until then, each when it is.
  void send_until(Stamp until, replay::NetworkPlayer& player);

  std::uint64_t sent() const { return sent_; }

 private:
  void insert(const transport::CanFrame& frame);

  replay::SendClock& clock_;
  replay::CanSender sender_;
  CanImu imu_;
  can::WheelSignals wheels_;
  std::deque<transport::CanFrame> waiting_;  // by time
  std::uint64_t sent_ = 0;
};

}  // namespace slamd::simulate
