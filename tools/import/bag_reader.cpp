#include "tools/import/bag_reader.hpp"

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <map>

#include "drivers/recording/packet.hpp"

namespace slamd::importing {

struct BagReader::Library {
  rosbag::Bag bag;
};

bool BagReader::available() {
  return true;
}

BagReader::BagReader(const std::filesystem::path& path)
    : path_(path), library_(std::make_unique<Library>()) {
  try {
    library_->bag.open(path.string(), rosbag::bagmode::Read);
    rosbag::View view(library_->bag);
    std::map<std::string, BagTopic> topics;
    for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
      topics[connection->topic].name = connection->topic;
      topics[connection->topic].type = connection->datatype;
    }
    for (auto& [name, topic] : topics) {
      topic.messages = rosbag::View(library_->bag, rosbag::TopicQuery(name)).size();
      topics_.push_back(topic);
    }
  } catch (const rosbag::BagException& error) {
    throw recording::RecordingError(path, error.what());
  }
}

BagReader::~BagReader() = default;

void BagReader::read(const std::vector<std::string>& topics, const OnMessage& message) const {
  try {
    rosbag::View view(library_->bag, rosbag::TopicQuery(topics));
    const double count = std::max(static_cast<double>(view.size()), 1.0);
    double done = 0.0;
    std::vector<std::uint8_t> bytes;
    for (const rosbag::MessageInstance& instance : view) {
      bytes.resize(instance.size());
      ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
      instance.write(stream);
      message(instance.getTopic(), std::as_bytes(std::span(bytes)), ++done / count);
    }
  } catch (const rosbag::BagException& error) {
    throw recording::RecordingError(path_, error.what());
  }
}

}  // namespace slamd::importing
