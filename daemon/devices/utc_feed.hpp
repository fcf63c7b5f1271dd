#pragma once

#include <optional>

#include "core/base/stamp.hpp"
#include "core/sensor/gnss_fix.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::devices {

/// Tells a device with PPS which second its last edge began: once for each whole second that a receiver has named, and
/// only while that edge is the last one.
/// Source: livox-sdk1.md §5.2 (10 to 500 ms after the edge), gnss.md §3 (a sentence names the second of the edge before it).
/// Threads: one.  Real-time: no allocation.
class UtcFeed {
 public:
  /// An older fix is of no use: receivers take up to 200 ms to speak, and the next edge is near.
  static constexpr Duration kNewest = std::chrono::milliseconds(300);

  /// Returns what the device is to be told now, if anything.
  std::optional<livox::Sdk1Utc> due(const sensor::GnssFix& fix, Stamp now);

 private:
  std::optional<std::chrono::sys_seconds> told_;
};

}  // namespace slamd::devices
