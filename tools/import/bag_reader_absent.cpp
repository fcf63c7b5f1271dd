// Built in place of bag_reader.cpp where Debian's librosbag is not installed.
#include "drivers/recording/packet.hpp"
#include "tools/import/bag_reader.hpp"

namespace slamd::importing {

struct BagReader::Library {};

bool BagReader::available() {
  return false;
}

BagReader::BagReader(const std::filesystem::path& path) {
  throw recording::RecordingError(
      path,
      "this slamd-import was built without ROS bags: install librosbag-storage-dev, build again");
}

BagReader::~BagReader() = default;

void BagReader::read(const std::vector<std::string>&, const OnMessage&) const {}

}  // namespace slamd::importing
