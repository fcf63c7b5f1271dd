#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/sensor/imu_reading.hpp"
#include "drivers/transport/can_frame.hpp"
#include "drivers/imu/inertial_result.hpp"

namespace slamd::can {

using transport::CanFrame;

/// Decodes the frames of an Xsens MTi-600 (11-bit ids as delivered, big-endian) into inertial samples.
///
/// A sample comes as a group of frames, one quantity each, SampleTime before what was measured: it is complete with
/// SampleTime, RateOfTurn and Acceleration, and given up when one of its ids, or the next time, comes before. Its time is SampleTime, 0.1 ms ticks, carried on over the wrap;
/// gaps of GroupCounter are counted. Of a quantity that also comes in high resolution (HR) only that is taken.
/// Source: imu-can.md §A. Real-time: never allocates; O(1); one thread.
class XsensCanReader {
 public:
  /// Returns which frames samples are made of, for the kernel.
  static std::vector<transport::CanFilter> frames();

  /// Takes a frame. Returns true when it completes a good sample, which is then in `reading`.
  bool take(const CanFrame& frame, sensor::ImuReading& reading);

  /// Samples by what became of them; kOther counts frames.
  const imu::InertialCounters& counters() const { return counters_; }

 private:
  /// What has come of a group.
  struct Group {
    std::uint32_t seen = 0;  // bit by bit, which quantities
    std::uint32_t ticks = 0;
    Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
    bool is_complete = false;
  };

  void begin_group();
  void count(imu::InertialResult result) { ++counters_.frames[static_cast<std::size_t>(result)]; }
  void note_counter(std::uint16_t counter);
  bool finish(Stamp received, sensor::ImuReading& reading);

  Group group_;
  std::uint32_t high_resolution_ = 0;  // quantities that have come so
  std::optional<std::uint32_t> last_ticks_;
  std::optional<std::uint16_t> last_counter_;
  std::int64_t ticks_ = 0;  // carried on over the wrap
  imu::InertialCounters counters_;
};

}  // namespace slamd::can
