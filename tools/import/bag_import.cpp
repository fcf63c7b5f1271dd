#include "tools/import/bag_import.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "core/base/units.hpp"
#include "tools/cli/cli.hpp"
#include "tools/import/ros_messages.hpp"

namespace slamd::importing {

namespace fs = std::filesystem;

namespace {

constexpr const char* kVelodyneScan = "velodyne_msgs/VelodyneScan";
constexpr const char* kPointCloud2 = "sensor_msgs/PointCloud2";
constexpr const char* kImu = "sensor_msgs/Imu";
constexpr std::array kLivoxTypes = {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"};
constexpr std::uint16_t kVelodynePort = 2368;
constexpr std::uint32_t kVelodyneAddress = 0xC0A801C9;  // 192.168.1.201, as delivered
constexpr std::size_t kVelodyneModelByte = 1205;
constexpr Duration kPeriod = std::chrono::milliseconds{100};

bool is_livox(const std::string& type) {
  return std::find(kLivoxTypes.begin(), kLivoxTypes.end(), type) != kLivoxTypes.end();
}

/// 0: no LiDAR; the higher, the better.
int lidar_rank(const std::string& type) {
  if (type == kVelodyneScan) {
    return 3;
  }
  return is_livox(type) ? 2 : (type == kPointCloud2 ? 1 : 0);
}

/// The topic that was asked for, or the best of those with a rank.
std::optional<BagTopic> choose(const std::vector<BagTopic>& topics,
                               const std::string& wanted,
                               const std::function<int(const std::string& type)>& rank) {
  std::optional<BagTopic> best;
  for (const BagTopic& topic : topics) {
    const int value = rank(topic.type);
    if (value == 0 || (!wanted.empty() && topic.name != wanted)) {
      continue;
    }
    const bool better = !best || value > rank(best->type) ||
                        (value == rank(best->type) && topic.messages > best->messages);
    best = better ? topic : best;
  }
  if (!best && !wanted.empty()) {
    throw cli::UsageError("the bag has no topic " + wanted + " of a type that can be imported");
  }
  return best;
}

const char* velodyne_model(std::byte factory) {
  switch (std::to_integer<int>(factory)) {
    case 0x21:
      return "hdl32e";
    case 0x24:
      return "vlp16_hires";
    case 0x28:
      return "vlp32c";
    default:
      return "vlp16";
  }
}

/// Keeps inertial samples until it is known whether they are in g, then writes them.
class ImuSink {
 public:
  explicit ImuSink(const fs::path& file) : csv_(file) {}

  void add(const sensor::ImuSample& sample) {
    first_.push_back(sample);
    if (first_.size() == kFirst) {
      release();
    }
  }

  void close() {
    release();
    csv_.close();
  }

  bool in_g() const { return scale_ != 1.0; }

  std::uint64_t rows() const { return csv_.rows(); }

 private:
  static constexpr std::size_t kFirst = 200;

  void release() {
    if (!decided_ && !first_.empty()) {
      double sum = 0.0;
      for (const sensor::ImuSample& sample : first_) {
        sum += sample.specific_force_mps2.norm();
      }
      const double mean = sum / static_cast<double>(first_.size());
      scale_ = mean > 0.7 && mean < 1.4 ? kStandardGravity_mps2 : 1.0;
      decided_ = true;
    }
    for (sensor::ImuSample& sample : first_) {
      sample.specific_force_mps2 *= scale_;
      csv_.write(sample);
    }
    first_.clear();
  }

  ImuCsvWriter csv_;
  std::vector<sensor::ImuSample> first_;
  bool decided_ = false;
  double scale_ = 1.0;
};

/// Takes messages in, writes files.
class BagImport {
 public:
  BagImport(const fs::path& directory, const BagOptions& options, const std::string& lidar_type)
      : directory_(directory), lidar_type_(lidar_type), converter_(options.points_have_time) {}

  void add_lidar(std::span<const std::byte> message) {
    if (lidar_type_ == kVelodyneScan) {
      add_velodyne(message);
      return;
    }
    auto cloud = is_livox(lidar_type_) ? parse_livox_custom(message) : parse_point_cloud2(message);
    if (!cloud) {
      ++summary_.refused["malformed_lidar_message"];
      return;
    }
    add_cloud(*cloud);
  }

  void add_imu(std::span<const std::byte> message) {
    const auto sample = parse_imu(message);
    if (!sample) {
      ++summary_.refused["malformed_imu_message"];
      return;
    }
    if (!imu_) {
      imu_.emplace(directory_ / "imu.csv");
    }
    imu_->add(*sample);
  }

  Summary finish(const std::string& made_from) {
    RecordingToml toml;
    toml.made_from = made_from;
    toml.model = model_;
    toml.source = pcap_ ? "lidar.pcap" : "lidar";
    toml.points_have_time = have_time_;
    if (pcap_) {
      pcap_->close();
    }
    if (clouds_) {
      clouds_->close();
    }
    if (imu_) {
      imu_->close();
      toml.has_imu = imu_->rows() > 0;
      summary_.imu_samples = imu_->rows();
      if (imu_->in_g()) {
        summary_.remarks.emplace_back("the inertial samples were in g; they are in m/s² now");
      }
    }
    if (summary_.scans == 0) {
      throw recording::RecordingError(made_from, "no LiDAR message could be read");
    }
    write_recording_toml(directory_, toml);
    return std::move(summary_);
  }

 private:
  void add_velodyne(std::span<const std::byte> message) {
    const bool good =
        parse_velodyne_scan(message, [&](Stamp stamp, std::span<const std::byte> payload) {
          if (!pcap_) {
            pcap_.emplace(directory_ / "lidar.pcap");
            model_ = velodyne_model(payload[kVelodyneModelByte]);
          }
          recording::Packet packet;
          packet.received = stamp;
          packet.source_address = kVelodyneAddress;
          packet.source_port = kVelodynePort;
          packet.destination_port = kVelodynePort;
          packet.payload = payload;
          pcap_->write(packet);
          ++summary_.packets;
        });
    summary_.scans += good ? 1 : 0;
    if (!good) {
      ++summary_.refused["malformed_lidar_message"];
    }
  }

  void add_cloud(CloudMessage& message) {
    if (const auto refusal = converter_.convert(message.cloud, cloud_)) {
      ++summary_.refused[std::string(name_of(*refusal))];
      return;
    }
    const auto place = clouds::place_in_time(cloud_, message.stamp, message.stamp, kPeriod);
    if (last_end_ && place.end <= *last_end_) {
      ++summary_.refused["stamp_not_increasing"];
      return;
    }
    if (!clouds_) {
      clouds_.emplace(directory_ / "lidar");
      have_time_ = cloud_.has_time;
    }
    last_end_ = place.end;
    clouds_->write(cloud_.points, have_time_, have_time_ ? place.begin : place.end);
    ++summary_.scans;
    summary_.points += cloud_.points.size();
  }

  fs::path directory_;
  std::string lidar_type_;
  clouds::CloudConverter converter_;
  clouds::Cloud cloud_;
  std::string model_ = "points";
  bool have_time_ = false;
  std::optional<Stamp> last_end_;
  std::optional<recording::PcapWriter> pcap_;
  std::optional<CloudSequenceWriter> clouds_;
  std::optional<ImuSink> imu_;
  Summary summary_;
};

}  // namespace

Summary import_bag(const fs::path& path,
                   const fs::path& directory,
                   const BagOptions& options,
                   const std::function<void(double share)>& progress) {
  const BagReader bag(path);
  const auto lidar = choose(bag.topics(), options.lidar_topic, lidar_rank);
  const auto imu = choose(bag.topics(), options.imu_topic, [](const std::string& type) {
    return type == kImu ? 1 : 0;
  });
  if (!lidar) {
    throw recording::RecordingError(
        path,
        "has no topic of velodyne_msgs/VelodyneScan, sensor_msgs/PointCloud2 or livox CustomMsg");
  }
  std::vector<std::string> topics = {lidar->name};
  if (imu) {
    topics.push_back(imu->name);
  }
  BagImport import(directory, options, lidar->type);
  bag.read(topics, [&](const std::string& topic, std::span<const std::byte> bytes, double share) {
    if (topic == lidar->name) {
      import.add_lidar(bytes);
    } else {
      import.add_imu(bytes);
    }
    progress(share);
  });
  Summary summary = import.finish(path.filename().string());
  summary.remarks.push_back("LiDAR from " + lidar->name + " (" + lidar->type +
                            "), inertial samples from " +
                            (imu ? imu->name : std::string("nowhere")));
  for (const BagTopic& topic : bag.topics()) {
    if (topic.name != lidar->name && (!imu || topic.name != imu->name)) {
      summary.remarks.push_back("not imported: " + topic.name + " (" + topic.type + ")");
    }
  }
  return summary;
}

}  // namespace slamd::importing
