#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "drivers/can/aceinna_imu.hpp"
#include "drivers/can/xsens_can.hpp"
#include "tools/sensors/inertial_watch.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Watches the frames of a CAN bus: how many of each id come, and whether an inertial sensor is among them.
/// Any frames may be given.  Threads: one.
class CanWatch {
 public:
  /// Frames of so many ids are told apart; the rest are counted.
  static constexpr std::size_t kMostIds = 256;

  void take(const transport::CanFrame& frame);
  void end_second();

  /// Without what the socket and the interface say.
  BusSeen seen() const;

 private:
  struct Id {
    std::uint8_t size = 0;
    SecondCount frames;
  };

  SecondCount frames_;
  std::uint64_t left_out_ = 0;
  std::map<std::pair<bool, std::uint32_t>, Id> ids_;  // by whether they are extended, and number
  can::XsensCanReader xsens_;
  can::AceinnaReader aceinna_;
  InertialWatch xsens_watch_;
  InertialWatch aceinna_watch_;
};

}  // namespace slamd::sensors
