#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/stamp.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/stamp_gate.hpp"

namespace slamd::sensor {

/// Says why a sample did not enter the buffer.
enum class ImuRefusal : std::uint8_t { kDuplicate, kOutOfOrder, kNotFinite, kImplausible, kFarAhead };

inline constexpr std::size_t kImuRefusals = 5;

/// Names a reason as reports and health spell it.
std::string_view to_string(ImuRefusal reason);

struct ImuBufferConfig {
  std::size_t capacity = 2048;           // samples: 10 s at 200 Hz
  double max_angular_rate_radps = 40.0;  // per axis; gyroscopes of the field end at 2000 °/s = 34.9
  double max_specific_force_mps2 = 320.0;  // per axis; accelerometers of the field end at 32 g
};

/// What happened to the samples since construction.
struct ImuBufferCounts {
  std::uint64_t accepted = 0;
  std::uint64_t overwritten = 0;  // accepted, then pushed out by newer ones before drop_before()
  std::uint64_t restarts = 0;     // what was newest was wild, or the clock went back: all before was forgotten
  std::array<std::uint64_t, kImuRefusals> refused{};

  std::uint64_t refused_for(ImuRefusal reason) const {
    return refused[static_cast<std::size_t>(reason)];
  }
};

/// Keeps the newest inertial samples in time order. When full, the oldest one makes room and is
/// counted. Samples lie at most one gap apart, whatever its length: who integrates looks at the
/// stamps. A gap of more than kLeap is entered by its second sample: the first could be a wild stamp (StampGate).
/// Real-time: allocates in the constructor only; one thread.
class ImuBuffer {
 public:
  static constexpr Duration kLeap = std::chrono::milliseconds{250};

  explicit ImuBuffer(const ImuBufferConfig& config);

  /// Appends a sample that is newer than all others; returns whether it did.
  /// Errors: refuses and counts a stamp that is equal to the newest (kDuplicate) or older
  /// (kOutOfOrder), the first that is newer by more than kLeap (kFarAhead), values that are not finite (kNotFinite)
  /// or beyond the configured range (kImplausible). After samples that were old for StampGate::kBackSpan it begins anew.
  bool push(const ImuSample& sample);

  std::size_t size() const { return size_; }

  bool empty() const { return size_ == 0; }

  /// The oldest and the newest sample.
  /// Errors: asking an empty buffer is a programmer error.
  const ImuSample& oldest() const;
  const ImuSample& newest() const;

  /// All samples, oldest first. Valid until the next push.
  std::span<const ImuSample> samples() const { return {ring_.data() + begin_, size_}; }

  /// The samples with t0 < stamp <= t1, oldest first. Valid until the next push.
  /// Real-time: O(log size).
  std::span<const ImuSample> between(Stamp t0, Stamp t1) const;

  /// Tells whether t lies between the oldest and the newest stamp, ends included.
  bool covers(Stamp t) const;

  /// Interpolates linearly at t; nothing when t is not covered.
  /// Real-time: O(log size).
  std::optional<ImuSample> at(Stamp t) const;

  /// Forgets what is not needed to answer at() from t on: all samples before the last one with
  /// stamp <= t.
  void drop_before(Stamp t);

  const ImuBufferCounts& counts() const { return counts_; }

 private:
  std::optional<ImuRefusal> refusal(const ImuSample& sample) const;
  std::optional<ImuRefusal> disorder(Stamp stamp);

  ImuBufferConfig config_;
  StampGate gate_{kLeap};
  // Each sample is written twice, capacity apart, so that any run of samples is contiguous.
  std::vector<ImuSample> ring_;
  std::size_t begin_ = 0;  // of the oldest, in [0, capacity)
  std::size_t size_ = 0;
  ImuBufferCounts counts_;
};

}  // namespace slamd::sensor
