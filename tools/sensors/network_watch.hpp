#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/sensor/point_block.hpp"
#include "drivers/imu/csv_rows.hpp"
#include "tools/sensors/lidar_watch.hpp"

namespace slamd::sensors {

/// Watches what comes from the network: tells LiDARs, and inertial sensors that send rows of CSV, by their senders'
/// addresses and by what they say, whatever the port. What none of them says is counted. Any bytes may be given, by anyone.  Threads: one.
class NetworkWatch {
 public:
  /// Of so many sensors of a kind it keeps account; what more there are is counted.
  static constexpr std::size_t kMostSensors = 32;

  NetworkWatch();

  /// own: this host's addresses, whose searches are not another host's. Returns whether the datagram was a sensor's, or
  /// another host's search.
  bool take(const Arrival& arrival, std::span<const transport::Interface> own);

  void end_second();

  /// Where the SDK2 devices that were found take questions.
  std::vector<livox::Endpoint> sdk2_devices() const;

  /// Adds the LiDARs that are not in `seen` yet, rows, searchers and left_out.
  void show(Stamp now, Seen& seen) const;

 private:
  /// One sender of rows.
  struct RowsWatch {
    std::uint32_t address = 0;
    std::uint16_t port = 0;
    imu::CsvRows decoder;
    InertialWatch samples;
  };

  bool take_sdk1_frames(const Arrival& arrival);
  bool take_sdk2_frames(const Arrival& arrival, std::span<const transport::Interface> own);
  bool take_sdk2_frame(const livox::Sdk2Frame& frame, const Arrival& arrival, std::span<const transport::Interface> own);
  bool take_data(const Arrival& arrival);
  bool take_rows(const Arrival& arrival);
  void note_searcher(std::uint32_t address, std::span<const transport::Interface> own);

  /// The watch of a LiDAR, which may be a new one; nullptr: there are too many.
  LidarWatch* watch(LidarProtocol protocol, std::uint32_t address);

  std::vector<std::unique_ptr<LidarWatch>> lidars_;
  std::vector<std::unique_ptr<LidarWatch>> probes_;  // one of each protocol, for what comes from elsewhere
  std::vector<std::unique_ptr<RowsWatch>> rows_;
  std::vector<std::uint32_t> searchers_;
  std::uint64_t left_out_ = 0;
  std::unique_ptr<sensor::PointBlock> scratch_;
};

}  // namespace slamd::sensors
