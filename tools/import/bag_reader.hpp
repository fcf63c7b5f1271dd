#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"

namespace slamd::importing {

struct BagTopic {
  std::string name;
  std::string type;  // "sensor_msgs/Imu"
  std::uint64_t messages = 0;
};

/// Reads ROS 1 bags (version 2.0; plain, bz2, lz4) with Debian's librosbag, where slamd was built
/// with it.
class BagReader {
 public:
  /// Tells whether this build can read bags.
  static bool available();

  /// Opens a bag. Errors: RecordingError, also where available() is false; then the message says
  /// what to install.
  explicit BagReader(const std::filesystem::path& path);
  ~BagReader();
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;

  const std::vector<BagTopic>& topics() const { return topics_; }

  /// Calls message(topic's name, bytes, share of all done) for each message of the given topics in
  /// the order of their reception. Errors: RecordingError for a damaged bag.
  using OnMessage =
      std::function<void(const std::string& topic, std::span<const std::byte> bytes, double share)>;
  void read(const std::vector<std::string>& topics, const OnMessage& message) const;

 private:
  struct Library;

  std::filesystem::path path_;
  std::unique_ptr<Library> library_;
  std::vector<BagTopic> topics_;
};

}  // namespace slamd::importing
