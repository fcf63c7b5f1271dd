#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"

namespace slamd::service {

/// How far a thread has come.
struct Pulse {
  const std::string& thread;
  bool may_block = false;
  std::uint64_t rounds = 0;
};

/// What goes in and what comes out.
struct Flow {
  std::uint64_t inputs = 0;  // that a pose each or more must follow
  std::uint64_t poses = 0;
  bool poses_expected = false;  // odom has begun: each input makes a pose
};

/// Judges whether slamd lives: each thread goes round its loop, and poses come while input flows.
/// An input that fails, as by an unplugged cable, is no reason to die; nor is odom that has not
/// begun. Threads: housekeeping.
class LifeWatch {
 public:
  /// A real-time thread goes round twenty times a second at least.
  static constexpr Duration kThreadPatience = std::chrono::seconds(1);
  /// A thread that may block: the kernel holds the closing of a serial port for up to 30 s.
  static constexpr Duration kBlockingPatience = std::chrono::seconds(60);
  /// Input that pauses for longer does not flow.
  static constexpr Duration kPause = std::chrono::milliseconds(500);
  /// Input flows, and no pose comes of it.
  static constexpr Duration kPosePatience = std::chrono::seconds(3);

  /// Looks at all threads, always in the same order, and at the poses.
  void look(const std::vector<Pulse>& pulses, const Flow& flow, Stamp now);

  /// Whether everything goes on, as of the last look.
  bool lives() const { return fault_.empty(); }

  /// What does not, in words, without changing numbers: "slamd-odometry hangs"; empty: it lives.
  const std::string& fault() const { return fault_; }

 private:
  /// When a count has changed last.
  struct Change {
    std::uint64_t count = 0;
    Stamp at{};

    void see(std::uint64_t new_count, Stamp now) {
      if (at == Stamp{} || new_count != count) {
        count = new_count;
        at = now;
      }
    }
  };

  bool poses_are_stale(const Flow& flow, Stamp now);

  std::vector<Change> rounds_;
  Change inputs_;
  Change poses_;
  Stamp flows_since_{};
  std::string fault_;
};

}  // namespace slamd::service
