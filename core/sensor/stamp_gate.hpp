#pragma once

#include <cstdint>
#include <optional>

#include "core/base/stamp.hpp"

namespace slamd::sensor {

/// Whether one stamp is later than another by more than a duration; they may be any 64 bits.
bool later_by_more(Stamp late, Stamp early, Duration duration);

/// What the stamps around it say of a stamp.
enum class StampVerdict : std::uint8_t {
  kInOrder,      // newer than all before it, and no leap; or a leap that the one before it had begun
  kAhead,        // a leap, the first of its kind: wild, or the first after a gap. The next stamp tells
  kOld,          // not newer than the newest
  kSteppedBack,  // old, as all were for a while: what was newest was wild, or the clock went back. Order begins anew here
};

/// Tells the wild stamps of one source from gaps and from steps of its clock, by their order alone.
///
/// A stamp that leaps ahead counts once a second one goes on from there: so a single wild one changes nothing. What passes
/// for the newest and is wild all the same (the first of all, two in a row) is given up after kBackSpan of stamps
/// that are old but in order among themselves, with no stamp in order between them.
///
/// Real-time: no allocation; O(1); one thread.
class StampGate {
 public:
  static constexpr Duration kBackSpan = std::chrono::milliseconds{250};
  static constexpr std::uint32_t kBackCount = 5;

  /// Whether the first stamp of all is believed, or counts as a leap.
  enum class First : std::uint8_t { kBelieved, kMustBeConfirmed };

  /// `leap`: stamps of a source that neither lost nor failed lie closer together.
  explicit StampGate(Duration leap, First first = First::kBelieved) : leap_(leap), believes_first_(first == First::kBelieved) {}

  StampVerdict judge(Stamp stamp);

 private:
  StampVerdict judge_old(Stamp stamp);

  Duration leap_;
  bool believes_first_;
  std::optional<Stamp> newest_;
  std::optional<Stamp> ahead_;  // a leap that waits for a second one
  // Old stamps in order among themselves.
  std::uint32_t back_count_ = 0;
  Stamp back_first_{};
  Stamp back_last_{};
};

}  // namespace slamd::sensor
