#include "drivers/transport/port_owner.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include <unistd.h>

namespace slamd::transport {

namespace {

namespace fs = std::filesystem;

/// What the descriptors of the sockets on this port point to: "socket:[inode]".
std::vector<std::string> sockets_on(std::uint16_t port) {
  std::vector<std::string> links;
  for (const char* table : {"/proc/net/udp", "/proc/net/udp6"}) {
    std::ifstream stream(table);
    std::string line;
    std::getline(stream, line);  // the header
    while (std::getline(stream, line)) {
      std::istringstream row(line);
      std::string slot, local, remote, state, queues, timer, retransmits, uid, timeout, inode;
      row >> slot >> local >> remote >> state >> queues >> timer >> retransmits >> uid >> timeout >> inode;
      const std::size_t colon = local.rfind(':');
      if (row && colon != std::string::npos && std::stoul(local.substr(colon + 1), nullptr, 16) == port) {
        links.push_back("socket:[" + inode + "]");
      }
    }
  }
  return links;
}

bool holds_any(const fs::path& process, const std::vector<std::string>& links) {
  std::error_code ignored;
  for (fs::directory_iterator entry(process / "fd", ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    std::error_code gone;
    if (std::find(links.begin(), links.end(), fs::read_symlink(*entry, gone).string()) != links.end()) {
      return true;
    }
  }
  return false;
}

/// Names the first process but `except` that has one of these open: "slamd (pid 123)"; empty where none is seen to.
std::string holder_of(const std::vector<std::string>& links, const std::string& except = {}) {
  std::error_code ignored;
  for (fs::directory_iterator entry("/proc", ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string pid = entry->path().filename();
    if (pid != except && pid.find_first_not_of("0123456789") == std::string::npos && holds_any(entry->path(), links)) {
      std::string name;
      std::ifstream stream(entry->path() / "comm");
      std::getline(stream, name);
      return name + " (pid " + pid + ")";
    }
  }
  return "";
}

}  // namespace

std::string owner_of_port(std::uint16_t port) {
  const std::vector<std::string> links = sockets_on(port);
  if (links.empty()) {
    return "";
  }
  const std::string holder = holder_of(links);
  return holder.empty() ? "another process" : holder;
}

std::string other_owner_of_port(std::uint16_t port) {
  std::vector<std::string> links = sockets_on(port);
  std::erase_if(links, [](const std::string& link) { return holds_any("/proc/self", {link}); });
  if (links.empty()) {
    return "";
  }
  const std::string holder = holder_of(links);
  return holder.empty() ? "another process" : holder;
}

std::string owner_of_terminal(const std::string& device) {
  std::error_code absent;
  const fs::path path = fs::canonical(device, absent);
  return absent ? "" : holder_of({path.string()}, std::to_string(getpid()));
}

std::string taken_in_words(std::uint16_t port) {
  const std::string owner = owner_of_port(port);
  return "is taken by " + (owner.empty() ? "another process" : owner);
}

}  // namespace slamd::transport
