#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/wire.hpp"

namespace slamd::simulate {

/// Something that begins at a moment of the recording and lasts, or moves a clock, by a time.  Units: s.
struct Event {
  double at_s = 0.0;
  double by_s = 0.0;
};

/// Bursts of packets that are lost together.
struct Bursts {
  int count = 0;
  int packets = 0;  // in each
};

/// What is to be done to a recording.
struct Faults {
  std::uint64_t seed = 1;
  double drop = 0.0;         // share of all packets
  Bursts burst;
  double reorder = 0.0;      // share of point packets that come a few packets late
  double duplicate = 0.0;    // share of point packets that come twice
  double truncate = 0.0;     // share of all packets that lose their end
  double garbage = 0.0;      // share of all packets whose bytes are noise
  std::vector<Event> clock_steps;   // of the LiDAR
  std::vector<Event> blackouts;     // no LiDAR packet at all
  std::vector<Event> imu_gaps;
  double imu_offset_s = 0.0;        // added to every inertial stamp
  std::optional<InertialLimits> imu_clip;
  std::optional<Sector> block_fov;
};

/// What was done to the packets of one kind.
struct PacketFaults {
  std::uint64_t read = 0;
  std::uint64_t blackout = 0;
  std::uint64_t gap = 0;        // inertial packets
  std::uint64_t burst = 0;
  std::uint64_t dropped = 0;
  std::uint64_t truncated = 0;
  std::uint64_t truncated_header = 0;  // of these: shorter than the header
  std::uint64_t garbage = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
  std::uint64_t clock_stepped = 0;
  std::uint64_t clipped = 0;
  std::uint64_t written = 0;
};

/// What was done to a recording.
struct FaultCounts {
  std::array<PacketFaults, kWires> packets{};
  std::uint64_t points_blocked = 0;
  std::uint64_t frames_not_udp = 0;  // are not copied
  std::uint64_t imu_rows_read = 0;
  std::uint64_t imu_rows_gap = 0;
  std::uint64_t imu_rows_clipped = 0;
  std::uint64_t imu_rows_written = 0;

  PacketFaults& of(Wire wire) { return packets[static_cast<std::size_t>(wire)]; }
  const PacketFaults& of(Wire wire) const { return packets[static_cast<std::size_t>(wire)]; }
};

/// Copies a recording (a directory, or a capture) and damages the copy. Writes faults.json beside it: what was asked
/// for, what was done, and what slamd-replay's report.json must therefore say under "packets".
/// Each packet suffers at most one of truncate, garbage, duplicate and reorder.
/// Errors: RecordingError.
FaultCounts inject_faults(const std::filesystem::path& in, const std::filesystem::path& out, const Faults& faults,
                          const std::function<void(double)>& progress);

/// Writes faults.json. Errors: RecordingError.
void write_faults(const Faults& faults, const FaultCounts& counts, const std::filesystem::path& file);

/// faults.json.
std::string faults_json(const Faults& faults, const FaultCounts& counts);

}  // namespace slamd::simulate
