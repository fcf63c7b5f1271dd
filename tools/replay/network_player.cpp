#include "tools/replay/network_player.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "drivers/livox/data_header.hpp"
#include "drivers/livox/sdk2_header.hpp"
#include "drivers/transport/udp_receiver.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::replay {

using configuration::LidarModel;
using recording::Packet;
using sensor::ImuSample;

namespace {

constexpr std::uint8_t kLivoxImu = 6;  // data type; livox-sdk1.md §5
constexpr std::uint8_t kSdk2Imu = 0;   // livox-sdk2.md §4

bool is_sdk1_imu(const Packet& packet) {
  return packet.payload.size() >= livox::DataHeader::kBytes && livox::parse_header(packet.payload).data_type == kLivoxImu;
}

bool is_sdk2_imu(const Packet& packet) {
  return packet.payload.size() >= livox::Sdk2Header::kBytes &&
         livox::parse_sdk2_header(packet.payload).data_type == kSdk2Imu;
}

std::uint32_t resolve(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0) {
    throw cli::UsageError("host " + host + ": " + gai_strerror(error));
  }
  const std::uint32_t address = ntohl(reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr.s_addr);
  freeaddrinfo(found);
  return address;
}

std::uint16_t parse_port(const std::string& text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port == 0) {
    throw cli::UsageError("port " + text + ": must be a whole number from 1 to 65535");
  }
  return port;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// What comes out of a terminal of this kind.
std::optional<imu::Protocol> protocol_of(const std::string& kind) {
  if (kind == "pty") {
    return imu::Protocol::kCsv;
  }
  for (const imu::Protocol protocol : {imu::Protocol::kXsens, imu::Protocol::kMip}) {
    if (kind == name_of(protocol)) {
      return protocol;
    }
  }
  return std::nullopt;
}

}  // namespace

void parse_destination(const std::string& option, const std::string& text, ToNetworkOptions& options) {
  const std::vector<std::string> parts = split(text);
  if (parts.size() > 3 || parts[0].empty()) {
    throw cli::UsageError(option + " " + text + ": must be HOST[:DATA_PORT[:POSITION_PORT]]");
  }
  options.address = resolve(parts[0]);
  options.data_port = parts.size() > 1 ? parse_port(parts[1]) : std::uint16_t{0};
  options.position_port = parts.size() > 2 ? parse_port(parts[2]) : std::uint16_t{0};
}

void parse_imu_destination(const std::string& text, ToNetworkOptions& options) {
  const std::vector<std::string> parts = split(text);
  if (parts.size() == 3 && parts[0] == "udp") {
    options.imu_address = resolve(parts[1]);
    options.imu_port = parse_port(parts[2]);
  } else if (const auto protocol = protocol_of(parts[0]); protocol && parts.size() > 1 && !parts[1].empty()) {
    options.imu_protocol = *protocol;
    options.imu_terminal = text.substr(parts[0].size() + 1);
  } else {
    throw cli::UsageError("--imu-to " + text + ": must be udp:HOST:PORT, pty:LINKPATH, xsens:LINKPATH or mip:LINKPATH");
  }
}

void parse_gnss_destination(const std::string& text, ToNetworkOptions& options) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string kind = text.substr(0, colon);
  const std::pair<const char*, GnssTalk> kinds[] = {{"nmea", GnssTalk::kNmea}, {"ubx", GnssTalk::kUbx}, {"both", GnssTalk::kBoth}};
  for (const auto& [name, talk] : kinds) {
    if (kind == name && colon + 1 < text.size()) {
      options.gnss_talk = talk;
      options.gnss_terminal = text.substr(colon + 1);
      return;
    }
  }
  throw cli::UsageError("--gnss-to " + text + ": must be nmea:LINKPATH, ubx:LINKPATH or both:LINKPATH");
}

Duration MonotonicSendClock::now() {
  std::timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec);
}

void MonotonicSendClock::sleep_until(Duration deadline) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(deadline);
  const std::timespec at{seconds.count(), (deadline - seconds).count()};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
}

void ask_for_punctuality() {
  const sched_param lowest_of_real_time{1};
  sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &lowest_of_real_time);
  prctl(PR_SET_TIMERSLACK, 1UL);
}

/// A socket that sends to anyone.
class NetworkPlayer::Socket {
 public:
  explicit Socket(SendClock& clock) : clock_(clock), fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const int on = 1;
    if (fd_ < 0 || setsockopt(fd_, SOL_SOCKET, SO_BROADCAST, &on, sizeof on) != 0) {
      throw std::runtime_error("no UDP socket to be had: " + std::generic_category().message(errno));
    }
  }
  ~Socket() { close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void send(std::span<const std::byte> payload, std::uint32_t address, std::uint16_t port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(address);
    while (sendto(fd_, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) < 0) {
      if (errno == ENOBUFS) {
        clock_.sleep_until(clock_.now() + kBurstPause);
      } else if (errno != EINTR) {
        throw std::runtime_error(transport::dotted(address) + ":" + std::to_string(port) +
                                 ": cannot be sent to: " + std::generic_category().message(errno));
      }
    }
  }

 private:
  SendClock& clock_;
  int fd_;
};

NetworkPlayer::NetworkPlayer(const configuration::LidarConfiguration& lidar, const ToNetworkOptions& options,
                             SendClock& clock, const std::function<bool()>& stopped)
    : lidar_(lidar), options_(options), clock_(clock), stopped_(stopped), socket_(std::make_unique<Socket>(clock)) {
  if (!options.imu_terminal.empty()) {
    device_ = emulated_imu(options.imu_protocol, options.imu_rate_hz);
    terminal_ = std::make_unique<SensorTerminal>(options.imu_terminal, device_->greeting());
  }
  if (!options.gnss_terminal.empty()) {
    gnss_terminal_ = std::make_unique<SensorTerminal>(options.gnss_terminal);
  }
}

NetworkPlayer::~NetworkPlayer() = default;

bool NetworkPlayer::takes_rows() const { return terminal_ || options_.imu_port != 0; }

void NetworkPlayer::wait_for_reader() {
  const Duration begin = clock_.now();
  const auto lacks_reader = [](const std::unique_ptr<SensorTerminal>& terminal) { return terminal && !terminal->has_reader(); };
  while ((lacks_reader(terminal_) || lacks_reader(gnss_terminal_)) && !is_stopped() && clock_.now() < begin + kReaderPatience) {
    clock_.sleep_until(clock_.now() + std::chrono::milliseconds(10));
  }
}

void NetworkPlayer::begin(Stamp first) {
  first_ = now_ = first;
  begin_ = clock_.now();
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  report_.wall_minus_recorded = std::chrono::duration_cast<Duration>(wall) - first_.time_since_epoch();
  if (takes_fixes()) {  // a receiver measures on whole parts of UTC's second, as recordings have it of their own
    const Duration wait = std::chrono::ceil<std::chrono::seconds>(report_.wall_minus_recorded) - report_.wall_minus_recorded;
    begin_ += wait;
    report_.wall_minus_recorded += wait;
  }
}

void NetworkPlayer::send(const Packet& packet) {
  const Kind kind = kind_of(packet);
  if (kind == Kind::kForeign) {
    ++report_.foreign;
    return;
  }
  if (!wait_until(packet.received)) {
    return;
  }
  const bool beside = kind == Kind::kPosition || (kind == Kind::kImu && lidar_.model == LidarModel::kLivoxMid360);
  const std::uint16_t port = beside ? options_.position_port : options_.data_port;
  socket_->send(packet.payload, options_.address, port == 0 ? packet.destination_port : port);
  switch (kind) {
    case Kind::kPosition: ++report_.position; break;
    case Kind::kImu: ++report_.imu_packets; break;
    default: ++report_.lidar; break;
  }
}

bool NetworkPlayer::send(const ImuSample& row, Stamp due) {
  if (!wait_until(due)) {
    return false;
  }
  if (terminal_) {
    device_bytes_.clear();
    if (!device_->sample(row, device_bytes_)) {
      ++report_.imu_withheld;
    } else {
      ++(terminal_->write(device_bytes_) ? report_.imu_rows : report_.imu_unheard);
    }
  } else {
    const std::string text = row_of(row);
    socket_->send(std::as_bytes(std::span(text.data(), text.size())), options_.imu_address, options_.imu_port);
    ++report_.imu_rows;
  }
  return true;
}

bool NetworkPlayer::send(const sensor::GnssFix& fix, Stamp due) {
  if (!wait_until(due)) {
    return false;
  }
  sensor::GnssFix told = fix;
  told.utc = sensor::UtcStamp(std::chrono::round<std::chrono::milliseconds>(due.time_since_epoch() + wall_minus_recorded()));
  ++(gnss_terminal_->write(message_of(told, options_.gnss_talk)) ? report_.gnss_fixes : report_.gnss_unheard);
  return true;
}

ToNetworkReport NetworkPlayer::finish() {
  report_.recording = now_ - first_;
  report_.took = clock_.now() - begin_;
  drain_terminals();
  report_.mean_lateness = events_ > 0 ? lateness_sum_ / events_ : Duration{};
  return report_;
}

NetworkPlayer::Kind NetworkPlayer::kind_of(const Packet& packet) const {
  if (is_livox(lidar_.model)) {
    const bool mid360 = lidar_.model == LidarModel::kLivoxMid360;
    const bool known = packet.destination_port == lidar_.port || (mid360 && packet.destination_port == lidar_.imu_port);
    if (lidar_.port != 0 && !known) {
      return Kind::kForeign;
    }
    return (mid360 ? is_sdk2_imu(packet) : is_sdk1_imu(packet)) ? Kind::kImu : Kind::kData;
  }
  if (packet.destination_port == lidar_.data_port()) {
    return Kind::kData;
  }
  return packet.destination_port == lidar_.position_port ? Kind::kPosition : Kind::kForeign;
}

bool NetworkPlayer::wait_until(Stamp due) {
  now_ = std::max(now_, due);
  if (options_.speed > 0.0) {
    const Duration deadline =
        begin_ + Duration(std::llround(static_cast<double>((now_ - first_).count()) / options_.speed));
    while (!is_stopped() && clock_.now() < deadline) {
      clock_.sleep_until(deadline);
      back_to_back_ = 0;
    }
    if (is_stopped()) {
      return false;
    }
    const Duration lateness = clock_.now() - deadline;
    report_.worst_lateness = std::max(report_.worst_lateness, lateness);
    lateness_sum_ += lateness;
    ++events_;
  }
  if (++back_to_back_ > kBurst) {  // late, or in no hurry: a receiver's buffer must not overflow
    clock_.sleep_until(clock_.now() + kBurstPause);
    back_to_back_ = 1;
  }
  serve_terminal();
  return !is_stopped();
}

/// Lets the device hear its host.
void NetworkPlayer::serve_terminal() {
  if (!terminal_) {
    return;
  }
  device_bytes_.clear();
  for (auto bytes = terminal_->read(); !bytes.empty(); bytes = terminal_->read()) {
    device_->hear(bytes, device_bytes_);
  }
  if (!device_bytes_.empty()) {
    terminal_->write(device_bytes_);
  }
}

bool NetworkPlayer::is_stopped() {
  report_.interrupted = report_.interrupted || (stopped_ && stopped_());
  return report_.interrupted;
}

/// Lets the readers take what is in the terminals, which go away with this program.
void NetworkPlayer::drain_terminals() {
  if (!terminal_ && !gnss_terminal_) {
    return;
  }
  const auto is_drained = [](const std::unique_ptr<SensorTerminal>& terminal) { return !terminal || terminal->is_drained(); };
  const Duration begin = clock_.now();
  bool drained = false;
  do {
    clock_.sleep_until(clock_.now() + std::chrono::milliseconds(20));
    serve_terminal();
    drained = is_drained(terminal_) && is_drained(gnss_terminal_);
  } while (!drained && !is_stopped() && clock_.now() < begin + std::chrono::seconds(1));
  const auto take_back = [](const std::unique_ptr<SensorTerminal>& terminal, std::uint64_t& sent, std::uint64_t& unheard) {
    const std::uint64_t left = terminal ? terminal->writes_left() : 0;
    sent -= std::min(sent, left);
    unheard += left;
  };
  take_back(terminal_, report_.imu_rows, report_.imu_unheard);
  take_back(gnss_terminal_, report_.gnss_fixes, report_.gnss_unheard);
}

}  // namespace slamd::replay
