#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/gnss/gnss_stream.hpp"
#include "drivers/gnss/local_frame.hpp"

namespace slamd::stages {

/// What is known of a satellite receiver. Trivially copyable, so that it passes through Latest.
struct GnssState {
  Stamp last_bytes{};    // arrival; zero: never
  Stamp last_message{};  // likewise, of a frame whose checksum holds
  Stamp first_good{};    // likewise, of a fix that is good
  Stamp last_good{};
  std::uint64_t fixes = 0;    // moments, good or not
  std::uint64_t good = 0;
  std::uint64_t damaged = 0;  // messages that came and could not be read
  sensor::GnssFix newest;     // good or not
  std::optional<sensor::UtcStamp> first_utc;  // of good fixes
  std::optional<sensor::UtcStamp> last_utc;
  std::optional<gnss::LocalFrame::Geodetic> origin;  // of enu: the first good fix with a height
  std::array<double, 3> p_enu_antenna_m{};           // of the last good fix since

  /// From the first good fix to the last, by the receiver's time where it tells it.
  Duration span() const { return first_utc ? *last_utc - *first_utc : last_good - first_good; }

  /// Whether the newest fix is good.
  bool has_fix() const { return newest.is_good(); }
};

/// The receive stage of one satellite receiver: bytes, or sentences out of packets, to fixes in a local frame.
/// Threads: one.  Real-time: never allocates but in counts().
class GnssStage {
 public:
  void add(std::span<const std::byte> bytes, Stamp received);

  /// Takes a sentence out of a packet; an empty one is nothing heard.
  void add_sentence(std::string_view sentence, Stamp received);

  /// Takes a fix that is decoded already.
  void add_fix(const sensor::GnssFix& fix);

  /// The port was closed: what is in hand becomes no more.
  void finish(Stamp received);

  const GnssState& state() const { return state_; }
  std::uint64_t messages() const { return stream_.counters().stream.frames; }

  /// By what became of them: fixes, messages, bytes; zeros are left out, but for the good fixes.
  std::vector<std::pair<std::string, std::uint64_t>> counts() const;

 private:
  void note_messages(Stamp received);

  gnss::GnssStream stream_;
  gnss::LocalFrame frame_;
  std::uint64_t messages_ = 0;
  GnssState state_;
};

}  // namespace slamd::stages
