#pragma once

#include <cstdint>
#include <optional>

#include "core/base/stamp.hpp"
#include "core/sensor/lower_envelope.hpp"

namespace slamd::sensor {

/// Says what a device's clock has to do with slamd's time base.
enum class ClockKind : std::uint8_t {
  kShared,     // same source (PTP, GPS) as the host: stamps pass through
  kEstimated,  // origin and rate of its own
};

struct ClockConfig {
  ClockKind kind = ClockKind::kEstimated;
  Duration roll_over{};  // the device's stamps begin again at zero after this long (Velodyne: 1 h);
                         // 0: never
};

/// What a clock has shown; for reports and health.
struct ClockHealth {
  std::uint64_t stamps = 0;
  std::uint64_t steps = 0;  // jumps of the device's clock that were followed
  std::uint64_t roll_overs = 0;
  std::uint64_t out_of_order = 0;  // not newer than the newest: duplicates, reordered packets
  std::uint64_t strays = 0;        // impossible stamps that no second one confirmed as a step
  Duration last_step{};            // by how much the device's clock jumped (forward > 0)
  Duration taken_off{};            // kShared: by how much the device's clock is ahead of the shared one since it jumped
  double skew = 0.0;               // rate of the host's clock over the device's, minus 1

  // Of arrival - mapped since clear_residual(): jitter and latency above the best.
  Duration residual_mean{};
  Duration residual_max{};
};

/// Maps the stamps of one device to slamd's time base.
///
/// kEstimated: a stamp maps to when its packet would have arrived with the smallest transport
/// latency: the lower envelope of arrival - device time over a sliding window of 12.8 s, with a
/// skew of at most kMaxSkew. Late and bursty arrivals lie above it and do not move it.
///
/// The first stamp, and the first after an outage longer than the window, maps to its own arrival.
/// From there the mapping approaches the envelope without a jump: it runs at most kAcquisitionSlew
/// faster or slower than the envelope during the first second and until it has met it, at most
/// kSlew afterwards. So, but for steps, packets in the order of their device stamps get increasing
/// stamps.
///
/// Steps of the device's clock (arrivals go on) are counted and followed, keeping the skew.
///
/// Forward: a sample more than kStep below the envelope cannot be. It maps to its own arrival, and
/// a second one that agrees confirms the step.
///
/// Backward: stamps older than the newest map to the past, as those of reordered packets do, until
/// kBackwardConfirmations of them over 50 ms of arrival agree. Where no stamp went back, it takes 1
/// s at 0.5 s above the envelope, or the whole window at kStep above. Smaller steps are slewed.
///
/// kShared: passes the stamp through as Unix nanoseconds; with a roll-over it picks the period so
/// that the result is within half a period of the arrival. Skew and small steps are only reported. A
/// step of more than kSharedStep says that the source is no longer shared: it is taken off, so that
/// time goes on as the arrivals do, until a step brings its stamps to the arrivals: it is the shared one
/// again, or at last, where a device that had just booted locks to its master. Until a
/// step is confirmed its stamps pass through, and are refused downstream as wild (StampGate).
///
/// Real-time: fixed memory, no allocation; O(1), and O(128) once in 100 ms; one thread.
class ClockModel {
 public:
  static constexpr double kMaxSkew = 200e-6;
  static constexpr double kSlew = 500e-6;
  static constexpr double kAcquisitionSlew = 0.02;
  static constexpr Duration kStep = std::chrono::milliseconds{10};
  static constexpr std::uint32_t kBackwardConfirmations = 5;
  static constexpr Duration kSharedStep = std::chrono::milliseconds{500};

  explicit ClockModel(const ClockConfig& config);

  /// Maps the device's stamp of an event of which the host heard at the given time. A LiDAR packet
  /// is stamped with its first firing but leaves after its last: pass received - duration,
  /// otherwise the result is late by the packet's duration (VLP-16: 1.3 ms). Deterministic: the
  /// result depends on the calls so far only. A duplicate of the newest stamp maps to what that
  /// mapped to.
  Stamp map(DeviceStamp device, Stamp arrival);

  /// Says after how long the stamps from now on begin again at zero; 0: never. A device that finds or loses its PPS
  /// counts otherwise from one packet to the next.
  void set_roll_over(Duration roll_over);

  const ClockHealth& health() const { return health_; }

  /// Begins new residual statistics.
  void clear_residual();

 private:
  // Device time x and arrival - device time y, counted from the anchor.
  using Sample = LowerEnvelope::Sample;

  // Samples that contradict the envelope but not each other: a step in the making.
  struct Candidate {
    std::uint32_t count = 0;  // 0: none
    bool forward = false;
    bool went_back = false;  // began with a stamp older than the newest
    std::int64_t newest_ns = 0;
    Stamp first_arrival{};
    double first_y_ns = 0.0;
    double least_y_ns = 0.0;
  };

  std::int64_t unrolled_ns(std::int64_t raw_ns, Stamp arrival) const;
  void anchor(std::int64_t device_ns, Stamp arrival, double envelope_y_ns, double applied_y_ns);
  std::int64_t offset_ns(std::int64_t device_ns, Stamp arrival);
  std::int64_t offset_forward_ns(const Sample& sample, std::int64_t device_ns, Stamp arrival);
  bool agrees(const Sample& sample, bool forward) const;
  bool confirms_backward_step(const Sample& sample, std::int64_t device_ns, Stamp arrival);
  void begin_candidate(const Sample& sample, std::int64_t device_ns, Stamp arrival, bool forward);
  void drop_candidate();
  void follow_step(const Sample& sample, std::int64_t device_ns, Stamp arrival);
  void begin_anew(const Sample& sample, std::int64_t device_ns, Stamp arrival);
  double envelope_at(Stamp arrival) const;
  void count_step(double step_ns);
  void note_shared_delay(Stamp arrival);
  void take_off_step();
  void advance(const Sample& sample, std::int64_t device_ns, Stamp arrival);
  std::int64_t applied_offset_ns(double x_ns) const;
  void count_residual(std::int64_t residual_ns);

  ClockConfig config_;
  ClockHealth health_;
  double residual_sum_ns_ = 0.0;
  std::uint64_t residuals_ = 0;

  // The anchor: the doubles below count from here, so that they resolve less than a nanosecond.
  bool anchored_ = false;
  std::int64_t anchor_device_ns_ = 0;
  std::int64_t anchor_offset_ns_ = 0;

  // The newest in-order sample, roll-overs undone.
  std::int64_t newest_device_ns_ = 0;
  std::int64_t newest_raw_ns_ = 0;
  Stamp newest_arrival_{};
  double newest_x_ns_ = 0.0;

  LowerEnvelope envelope_{kMaxSkew};
  // The mapping in use, at newest_x_ns_; it approaches the envelope.
  double applied_y_ns_ = 0.0;
  bool acquiring_ = true;

  // kShared: how far arrivals lay behind the device's clock when samples last bore it out, and what was taken off then.
  std::uint32_t borne_out_ = 0;  // samples since the anchor
  std::optional<std::int64_t> shared_delay_ns_;
  std::int64_t shared_taken_off_ns_ = 0;

  Candidate candidate_;
};

}  // namespace slamd::sensor
