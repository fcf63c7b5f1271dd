// Sends a daemon what no sensor and no client sends, for a while, and prints how much it was:
//
//   slamd_garbage SECONDS SEED udp DRIVE FROM TO PORT...   datagrams, from this address of the host
//   slamd_garbage SECONDS SEED pty DRIVE LINK              bytes of a terminal, which goes away and comes back
//   slamd_garbage SECONDS SEED lcm PREFIX                  to LCM's multicast group, the command channel above all
//
// Random bytes of all lengths; and packets, rows and commands that are right but for a cut, some changed bytes or a tail.
#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "daemon/bus/encoding.hpp"
#include "drivers/recording/pcap_reader.hpp"

namespace {

using namespace slamd;
using Bytes = std::vector<std::byte>;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kSamples = 4000;  // packets and rows to damage
constexpr int kBurst = 8;
constexpr std::chrono::milliseconds kPause{4};

class Damage {
 public:
  explicit Damage(std::uint64_t seed) : random_(seed) {}

  std::size_t below(std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_); }

  Bytes noise(std::size_t most) {
    Bytes bytes(below(most + 1));
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(below(256));
    }
    return bytes;
  }

  /// Whole, cut short, changed in some places, or with a tail.
  Bytes damaged(Bytes bytes) {
    switch (below(8)) {
      case 0: return bytes;
      case 1:
      case 2: bytes.resize(below(bytes.size() + 1)); return bytes;
      case 3: {
        const Bytes tail = noise(64);
        bytes.insert(bytes.end(), tail.begin(), tail.end());
        return bytes;
      }
      default:
        for (std::size_t i = 0; i <= below(16) && !bytes.empty(); ++i) {
          bytes[below(bytes.size())] = static_cast<std::byte>(below(256));
        }
        return bytes;
    }
  }

 private:
  std::mt19937_64 random_;
};

Bytes bytes_of(const std::string& text) {
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::vector<Bytes> packets_of(const std::filesystem::path& drive) {
  std::vector<Bytes> packets;
  recording::PcapReader reader(drive / "lidar.pcap");
  recording::Packet packet;
  while (packets.size() < kSamples && reader.next(packet)) {
    packets.emplace_back(packet.payload.begin(), packet.payload.end());
  }
  return packets;
}

std::vector<Bytes> rows_of(const std::filesystem::path& drive) {
  std::vector<Bytes> rows;
  std::ifstream file(drive / "imu.csv");
  for (std::string line; rows.size() < kSamples && std::getline(file, line);) {
    rows.push_back(bytes_of(line + "\n"));
  }
  return rows;
}

sockaddr_in address(const std::string& dotted, int port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, dotted.c_str(), &result.sin_addr) != 1) {
    throw std::runtime_error(dotted + ": no address");
  }
  return result;
}

/// Calls send_one() in bursts for a while; returns how often.
template <typename SendOne>
std::uint64_t keep_sending(std::chrono::seconds time, SendOne&& send_one) {
  std::uint64_t count = 0;
  const auto end = Clock::now() + time;
  while (Clock::now() < end) {
    for (int i = 0; i < kBurst; ++i) {
      send_one();
      ++count;
    }
    std::this_thread::sleep_for(kPause);
  }
  return count;
}

class Socket {
 public:
  explicit Socket(const std::string& from) : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    const sockaddr_in own = address(from, 0);
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
      throw std::runtime_error(from + ": " + std::strerror(errno));
    }
  }
  ~Socket() { close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void send(const Bytes& bytes, const sockaddr_in& to) const {
    sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }

 private:
  int fd_;
};

std::uint64_t to_udp(std::chrono::seconds time, Damage& damage, const std::vector<std::string>& arguments) {
  std::vector<Bytes> good = packets_of(arguments.at(0));
  const std::vector<Bytes> rows = rows_of(arguments.at(0));
  good.insert(good.end(), rows.begin(), rows.end());
  const Socket socket(arguments.at(1));
  std::vector<sockaddr_in> to;
  for (std::size_t i = 3; i < arguments.size(); ++i) {
    to.push_back(address(arguments.at(2), std::stoi(arguments[i])));
  }
  return keep_sending(time, [&] {
    const bool random = damage.below(3) == 0;
    socket.send(random ? damage.noise(damage.below(16) == 0 ? 8000 : 1472) : damage.damaged(good[damage.below(good.size())]),
                to[damage.below(to.size())]);
  });
}

int open_terminal(const std::filesystem::path& link) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) {
    throw std::runtime_error("no pseudo terminal");
  }
  std::filesystem::remove(link);
  std::filesystem::create_symlink(ptsname(terminal), link);
  return terminal;
}

std::uint64_t to_terminal(std::chrono::seconds time, Damage& damage, const std::vector<std::string>& arguments) {
  const std::vector<Bytes> rows = rows_of(arguments.at(0));
  const std::filesystem::path link = arguments.at(1);
  int terminal = open_terminal(link);
  auto next_loss = Clock::now() + std::chrono::seconds(3);
  const std::uint64_t count = keep_sending(time, [&] {
    const Bytes bytes = damage.below(3) == 0 ? damage.noise(600) : damage.damaged(rows[damage.below(rows.size())]);
    [[maybe_unused]] const ssize_t written = write(terminal, bytes.data(), bytes.size());  // full: nobody reads, and it is lost
    if (Clock::now() >= next_loss) {
      next_loss = Clock::now() + std::chrono::seconds(3);
      close(terminal);
      terminal = open_terminal(link);
    }
  });
  close(terminal);
  std::filesystem::remove(link);
  return count;
}

/// A whole datagram of LCM: magic, sequence number, channel, message.
Bytes framed(const std::string& channel, const Bytes& message, std::uint32_t sequence) {
  Bytes bytes = bytes_of("LC02");
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::byte>(sequence >> shift));
  }
  const Bytes name = bytes_of(channel);
  bytes.insert(bytes.end(), name.begin(), name.end());
  bytes.push_back(std::byte{0});
  bytes.insert(bytes.end(), message.begin(), message.end());
  return bytes;
}

Bytes some_command(Damage& damage) {
  // new-map is not among them: the map would never grow old enough to be damaged.
  static const std::array<const char*, 6> verbs{"save", "set-pose", "seal", "", "shutdown", "set-pose"};
  static const std::array<const char*, 7> texts{"1", "nan", "-1e308", "../../etc/passwd", "x", "", "%s%n"};
  bus::Command command;
  command.id = damage.below(std::size_t{1} << 40);
  command.verb = verbs[damage.below(verbs.size())];
  for (std::size_t i = damage.below(5); i > 0; --i) {
    command.arguments.emplace_back(damage.below(5) == 0 ? std::string(damage.below(256), 'a') : texts[damage.below(texts.size())]);
  }
  std::array<std::byte, bus::kLargestMessage_bytes> buffer{};
  const std::size_t size = bus::encode(command, buffer);
  return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size)};
}

std::uint64_t to_lcm(std::chrono::seconds time, Damage& damage, const std::vector<std::string>& arguments) {
  const Socket socket("127.0.0.1");
  const sockaddr_in to = address("239.255.76.67", 7667);
  const std::string channel = arguments.at(0) + "_COMMAND";
  std::uint32_t sequence = 0;
  return keep_sending(time, [&] {
    switch (damage.below(4)) {
      case 0: socket.send(damage.noise(1472), to); break;
      case 1: socket.send(framed(channel, damage.noise(1400), ++sequence), to); break;
      case 2: socket.send(framed(channel, damage.damaged(some_command(damage)), ++sequence), to); break;
      default: socket.send(damage.damaged(framed(channel, some_command(damage), ++sequence)), to); break;
    }
  });
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    const std::chrono::seconds time(std::stoi(words.at(0)));
    Damage damage(std::stoull(words.at(1)));
    const std::string& kind = words.at(2);
    const std::vector<std::string> arguments(words.begin() + 3, words.end());
    if (kind != "udp" && kind != "pty" && kind != "lcm") {
      throw std::runtime_error(kind + ": neither udp, pty nor lcm");
    }
    const std::uint64_t count = kind == "udp" ? to_udp(time, damage, arguments)
                                              : (kind == "pty" ? to_terminal(time, damage, arguments) : to_lcm(time, damage, arguments));
    std::printf("%llu\n", static_cast<unsigned long long>(count));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slamd_garbage: %s\n", error.what());
    return 1;
  }
}
