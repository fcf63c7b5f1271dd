#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/sensor/imu_reading.hpp"
#include "drivers/transport/can_frame.hpp"
#include "drivers/imu/inertial_result.hpp"

namespace slamd::can {

using transport::CanFrame;

/// Which number on the wire is which axis of imu. J1939 names pitch first, roll second and yaw third.
struct AxisMap {
  std::array<std::uint8_t, 3> wire{1, 0, 2};  // of x, y and z: the place on the wire, 0 to 2
  std::array<double, 3> sign{1.0, 1.0, 1.0};
};

/// Reads a map as configured: which axis comes first on the wire, which second and which third, turned round where a '-'
/// stands before it: "y,x,z", or "y,x,-z". Nothing when it is none.
std::optional<AxisMap> parse_axis_map(std::string_view text);

/// Decodes the frames of an Aceinna OpenIMU300RI or MTLT (SAE J1939, 29-bit ids) into inertial samples.
///
/// Acceleration and turn rate come in frames of their own, 0.3 ms apart; those that come within kTogether are a sample.
/// Nothing on the bus tells the time: it is the newer frame's arrival minus the latency that it states, and as a device's
/// stamp it is on slamd's time base (ClockKind::kShared). Values that the device marks as an error or not available are
/// kIncomplete.
/// Source: imu-can.md §B. Real-time: never allocates; O(1); one thread.
class AceinnaReader {
 public:
  static constexpr Duration kTogether = std::chrono::milliseconds{2};

  /// source: the device's address on the bus; none: whichever speaks.
  explicit AceinnaReader(const AxisMap& axes = {}, std::optional<std::uint8_t> source = std::nullopt)
      : axes_(axes), source_(source) {}

  /// Returns which frames samples are made of, for the kernel.
  static std::vector<transport::CanFilter> frames(std::optional<std::uint8_t> source);

  /// Takes a frame. Returns true when it completes a good sample, which is then in `reading`.
  bool take(const CanFrame& frame, sensor::ImuReading& reading);

  /// Samples by what became of them; kOther counts frames.
  const imu::InertialCounters& counters() const { return counters_; }

 private:
  /// A vector that waits for its counterpart.
  struct Half {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();  // in imu, SI
    Stamp received{};
    Stamp measured{};
  };

  void count(imu::InertialResult result) { ++counters_.frames[static_cast<std::size_t>(result)]; }
  Eigen::Vector3d in_imu(const Eigen::Vector3d& on_wire) const;

  AxisMap axes_;
  std::optional<std::uint8_t> source_;
  std::optional<Half> force_;
  std::optional<Half> rate_;
  imu::InertialCounters counters_;
};

}  // namespace slamd::can
