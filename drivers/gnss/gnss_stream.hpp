#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/counter.hpp"
#include "drivers/gnss/fix_epoch.hpp"
#include "drivers/gnss/gnss_frames.hpp"

namespace slamd::gnss {

/// What became of a good frame.
enum class MessageResult : std::uint8_t {
  kPart,       // of a fix
  kOther,      // none of RMC, GGA, GST and NAV-PVT
  kMalformed,  // one of them, but with fields that cannot be
  kNoTime,     // one of them, of a receiver that does not know the time yet
  kRepeated,   // said that again of a moment whose fix is out
  kLate,       // belongs to a fix that is out: the next one waits for its like
};

inline constexpr std::size_t kMessageResults = 6;

/// Names a result as reports and health spell it.
const char* name_of(MessageResult result);

struct GnssCounters {
  std::array<std::uint64_t, kMessageResults> messages{};  // by MessageResult
  std::array<std::uint64_t, kFixVerdicts> fixes{};        // by FixVerdict
  transport::StreamCounters stream;

  std::uint64_t of(MessageResult result) const { return messages[static_cast<std::size_t>(result)]; }
  std::uint64_t of(FixVerdict verdict) const { return fixes[static_cast<std::size_t>(verdict)]; }
};

/// A receiver's bytes to fixes, one for each moment, whatever mixture of sentences and UBX comes and in whatever order.
/// A moment is over when another begins, or, so that no fix waits for the next, when all has come that the moment before
/// had. Messages of one moment differ by no more than kSameMoment: u-blox rounds in sentences, and does not in NAV-PVT.
/// Errors: what is refused is counted by reason. Any bytes may be given.
/// Threads: one, but counters() is for any.  Real-time: never allocates; O(bytes).
class GnssStream {
 public:
  static constexpr Duration kSameMoment = std::chrono::milliseconds(15);

  /// Takes the next bytes; calls visit(const sensor::GnssFix&) for each fix, good or not. Its stamp is when its first
  /// message was `received`.
  template <typename Visit>
  void add(std::span<const std::byte> bytes, Stamp received, Visit&& visit) {
    frames_.add(bytes, [&](std::span<const std::byte> frame) { take_frame(frame, received, visit); });
  }

  /// Takes one sentence "$...*hh" that came without a stream, in a packet; one that is damaged counts as malformed.
  template <typename Visit>
  void add_sentence(std::string_view sentence, Stamp received, Visit&& visit) {
    take(read_sentence(sentence), received, visit);
  }

  /// Ends the stream, which was interrupted: the fix in hand is out, and no moment is known any more.
  template <typename Visit>
  void finish(Stamp received, Visit&& visit) {
    frames_.finish([&](std::span<const std::byte> frame) { take_frame(frame, received, visit); });
    close(visit);
    time_.reset();
    expected_ = 0;
  }

  /// Bytes in hand, that may become a frame.
  std::size_t pending() const { return frames_.pending(); }

  GnssCounters counters() const;

  /// Calls visit(const char* name, std::uint64_t count) for each thing that is counted, good fixes first.
  template <typename Visit>
  void each_count(Visit&& visit) const {
    const GnssCounters counters = this->counters();
    for (std::size_t i = 0; i < kFixVerdicts; ++i) {
      visit(i == 0 ? "fix" : name_of(static_cast<FixVerdict>(i)), counters.fixes[i]);
    }
    for (std::size_t i = 1; i < kMessageResults; ++i) {
      visit(name_of(static_cast<MessageResult>(i)), counters.messages[i]);
    }
    visit("damaged", counters.stream.damaged);
    visit("skipped_bytes", counters.stream.skipped_bytes);
  }

 private:
  enum Kind : unsigned { kRmc = 1, kGga = 2, kGst = 4, kPvt = 8 };

  /// A message that is part of a fix; no kind: none.
  struct Part {
    unsigned kind = 0;
    Duration time_of_day{};
    FixEpoch epoch;  // with this message alone
  };

  template <typename Visit>
  void take_frame(std::span<const std::byte> frame, Stamp received, Visit& visit) {
    take(read_frame(frame), received, visit);
  }

  template <typename Visit>
  void take(const Part& part, Stamp received, Visit& visit) {
    if (part.kind == 0) {
      return;
    }
    if (!time_ || !is_same_moment(*time_, part.time_of_day)) {
      close(visit);
      begin(part.time_of_day, received);
    }
    if (put(part) && seen_ == expected_) {
      close(visit);
    }
  }

  template <typename Visit>
  void close(Visit& visit) {
    if (is_open_) {
      sensor::GnssFix fix;
      finish_moment(fix);
      visit(static_cast<const sensor::GnssFix&>(fix));
    }
  }

  Part read_frame(std::span<const std::byte> frame);
  Part read_sentence(std::string_view sentence);
  template <typename Message>
  Part read_part(unsigned kind, const std::optional<Message>& message, std::optional<Message> FixEpoch::*member);
  static bool is_same_moment(Duration a, Duration b);
  void begin(Duration time_of_day, Stamp received);
  bool put(const Part& part);
  void finish_moment(sensor::GnssFix& fix);
  void count(MessageResult result) { messages_[static_cast<std::size_t>(result)].add(); }

  transport::ByteFrames<GnssFrames> frames_;
  std::array<Counter, kMessageResults> messages_;
  std::array<Counter, kFixVerdicts> fixes_;
  std::optional<Duration> time_;  // of the moment in hand, or of the fix that went out last
  bool is_open_ = false;          // the moment's fix is not out
  unsigned seen_ = 0;             // kinds of the moment
  unsigned expected_ = 0;         // kinds of the one before; 0: not known
  Stamp received_{};
  FixEpoch epoch_;
};

}  // namespace slamd::gnss
