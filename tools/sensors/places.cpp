#include "tools/sensors/places.hpp"

#include <algorithm>
#include <fstream>
#include <set>

namespace slamd::sensors {

namespace fs = std::filesystem;

namespace {

/// The entries of a folder, in order; none where it cannot be read.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    entries.push_back(entry->path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace

std::vector<std::string> serial_adapters(const fs::path& dev) {
  std::vector<std::string> found;
  std::set<fs::path> named;
  for (const fs::path& link : entries_of(dev / "serial" / "by-id")) {
    std::error_code broken;
    const fs::path device = fs::canonical(link, broken);
    if (!broken && named.insert(device).second) {
      found.push_back(link.string());
    }
  }
  for (const fs::path& device : entries_of(dev)) {
    const std::string name = device.filename().string();
    std::error_code broken;
    if ((name.starts_with("ttyUSB") || name.starts_with("ttyACM")) && !named.contains(fs::canonical(device, broken))) {
      found.push_back(device.string());
    }
  }
  return found;
}

bool is_same_device(const std::string& a, const std::string& b) {
  std::error_code absent_a;
  std::error_code absent_b;
  const fs::path device_a = fs::canonical(a, absent_a);
  const fs::path device_b = fs::canonical(b, absent_b);
  return a == b || (!absent_a && !absent_b && device_a == device_b);
}

std::vector<std::string> can_interfaces(const fs::path& net) {
  constexpr int kCanLink = 280;  // ARPHRD_CAN
  std::vector<std::string> found;
  for (const fs::path& interface : entries_of(net)) {
    int type = 0;
    if (std::ifstream(interface / "type") >> type && type == kCanLink) {
      found.push_back(interface.filename().string());
    }
  }
  return found;
}

}  // namespace slamd::sensors
