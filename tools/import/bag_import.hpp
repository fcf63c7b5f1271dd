#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/clouds/conversion.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "tools/import/bag_reader.hpp"
#include "tools/import/cloud_sequence.hpp"
#include "tools/import/recording_writer.hpp"
#include "tools/import/summary.hpp"

namespace slamd::importing {

struct BagOptions {
  std::string
      lidar_topic;  // empty: the one of a known type with the most messages, packets before clouds
  std::string imu_topic;  // empty: the one with the most messages
  bool points_have_time = true;
};

/// Turns a bag into a recording: velodyne_msgs/VelodyneScan into lidar.pcap (port 2368),
/// sensor_msgs/PointCloud2 and Livox CustomMsg into a sequence of clouds, sensor_msgs/Imu into
/// imu.csv.
///
/// CustomMsg becomes clouds, not packets again: the driver has dropped what a packet needs besides
/// the points (the firings' places in their packets), while a cloud keeps all there is: time, line
/// and tag of each point. Inertial samples in g (Livox drivers) are noticed by their mean and
/// scaled. Errors: RecordingError; UsageError for a topic that is not there.
Summary import_bag(const std::filesystem::path& bag,
                   const std::filesystem::path& directory,
                   const BagOptions& options,
                   const std::function<void(double share)>& progress);

}  // namespace slamd::importing
