#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/counter.hpp"

namespace slamd::transport {

/// What a protocol says of the bytes at a place of its stream.
enum class FrameVerdict : std::uint8_t {
  kFrame,      // begins here, complete and with a good checksum
  kNeedsMore,  // may begin here
  kNoFrame,    // does not begin here
  kDamaged,    // would, but for its checksum
};

struct FrameView {
  FrameVerdict verdict = FrameVerdict::kNoFrame;
  std::size_t size = 0;  // kFrame: of the whole frame
};

struct StreamCounters {
  std::uint64_t frames = 0;
  std::uint64_t frame_bytes = 0;
  std::uint64_t skipped_bytes = 0;  // outside of any good frame
  std::uint64_t damaged = 0;        // places where a frame would have begun, but for its checksum
};

/// Finds the frames of a serial protocol in a stream that comes in pieces of any size, with garbage,
/// losses and beginnings in the middle of a frame. After a damaged frame the search goes on one byte
/// behind its beginning, so that no whole frame is lost with it.
///
/// Protocol has kLongest (bytes of its longest frame) and inspect(bytes) -> FrameView, which says
/// kNeedsMore only while fewer than kLongest bytes are there.
/// Threads: one, but counters() is for any.  Real-time: never allocates; O(bytes), and O(bytes ·
/// kLongest) for an adversary's.
template <typename Protocol>
class ByteFrames {
 public:
  /// Takes the next bytes; calls visit(std::span<const std::byte> frame) for each good frame.
  template <typename Visit>
  void add(std::span<const std::byte> bytes, Visit&& visit) {
    while (!bytes.empty()) {
      const std::size_t piece = std::min(bytes.size(), buffer_.size() - size_);
      std::copy_n(bytes.begin(), piece, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
      size_ += piece;
      bytes = bytes.subspan(piece);
      take_frames(visit, false);
    }
  }

  /// Ends the stream: what is in hand becomes no frame any more, but there may be whole ones in it.
  template <typename Visit>
  void finish(Visit&& visit) {
    take_frames(visit, true);
  }

  /// Forgets what is in hand: the stream was interrupted.
  void restart() {
    skipped_bytes_.add(size_);
    size_ = 0;
  }

  /// Bytes in hand, that may become a frame.
  std::size_t pending() const { return size_; }

  StreamCounters counters() const {
    return {frames_.value(), frame_bytes_.value(), skipped_bytes_.value(), damaged_.value()};
  }

 private:
  template <typename Visit>
  void take_frames(Visit& visit, bool is_end) {
    std::size_t at = 0;
    while (at < size_) {
      const std::span<const std::byte> rest(buffer_.data() + at, size_ - at);
      const FrameView view = Protocol::inspect(rest);
      if (view.verdict == FrameVerdict::kNeedsMore && !is_end) {
        break;
      }
      if (view.verdict == FrameVerdict::kFrame) {
        frames_.add();
        frame_bytes_.add(view.size);
        visit(rest.first(view.size));
        at += view.size;
        continue;
      }
      if (view.verdict == FrameVerdict::kDamaged) {
        damaged_.add();
      }
      skipped_bytes_.add();
      ++at;
    }
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(at), buffer_.begin() + static_cast<std::ptrdiff_t>(size_),
              buffer_.begin());
    size_ -= at;
  }

  std::array<std::byte, 2 * Protocol::kLongest> buffer_{};
  std::size_t size_ = 0;
  Counter frames_;
  Counter frame_bytes_;
  Counter skipped_bytes_;
  Counter damaged_;
};

}  // namespace slamd::transport
