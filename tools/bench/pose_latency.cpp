#include "tools/bench/pose_latency.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/bus/connection.hpp"
#include "daemon/bus/encoding.hpp"
#include "daemon/bus/messages.hpp"
#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "drivers/transport/host_clock.hpp"
#include "tools/simulate/simulate.hpp"

namespace slamd::bench {

namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t kImuPort = 7501;
constexpr std::size_t kPose_bytes = 247;  // what comes behind is padding (docs/protocol.md)
constexpr int kSensorPriority = 60;       // before the daemon's threads, as interrupts are
constexpr int kSubscriberPriority = 40;   // behind them
constexpr Duration kRowDelay = std::chrono::microseconds(200);  // from a sample's moment to the end of its transmission

Duration monotonic_now() { return transport::read_clocks().monotonic; }

[[noreturn]] void throw_errno(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

/// Lets the calling thread, and those that it makes, run under SCHED_FIFO.
void take_priority(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) {
    throw_errno("SCHED_FIFO is not permitted, so there is nothing to compare");
  }
}

/// A folder that goes away with its owner.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "slamd-bench-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw_errno(name);
    }
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A process that ends with its owner.
class Child {
 public:
  template <typename Body>
  explicit Child(Body&& body) : pid_(fork()) {
    if (pid_ < 0) {
      throw_errno("fork");
    }
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      body();
      _exit(127);
    }
  }
  ~Child() { end(SIGKILL); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Ends it and returns its status as waitpid() tells it.
  int end(int signal) {
    int status = 0;
    if (pid_ > 0) {
      kill(pid_, signal);
      waitpid(pid_, &status, 0);
      pid_ = -1;
    }
    return status;
  }

 private:
  pid_t pid_;
};

/// A datagram of the drive.
struct Sending {
  Duration at{};              // since the drive's first
  std::uint16_t port = 0;
  std::vector<std::byte> payload;  // of a row: what stands behind its stamp
  bool is_row = false;
};

std::vector<std::byte> bytes_of(const char* text) {
  std::vector<std::byte> bytes(std::strlen(text));
  std::memcpy(bytes.data(), text, bytes.size());
  return bytes;
}

std::vector<Sending> read_drive(const fs::path& folder) {
  std::vector<Sending> drive;
  recording::PcapReader packets(folder / "lidar.pcap");
  recording::Packet packet;
  Stamp first{};
  while (packets.next(packet)) {
    first = drive.empty() ? packet.received : first;
    drive.push_back({packet.received - first, packet.destination_port, {packet.payload.begin(), packet.payload.end()}, false});
  }
  recording::ImuCsvReader rows(folder / "imu.csv");
  sensor::ImuSample sample;
  while (rows.next(sample)) {
    if (sample.stamp < first) {
      continue;
    }
    char text[160];
    const Eigen::Vector3d& w = sample.angular_rate_radps;
    const Eigen::Vector3d& f = sample.specific_force_mps2;
    std::snprintf(text, sizeof text, ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", w.x(), w.y(), w.z(), f.x(), f.y(), f.z());
    drive.push_back({sample.stamp - first, kImuPort, bytes_of(text), true});
  }
  std::stable_sort(drive.begin(), drive.end(), [](const Sending& a, const Sending& b) { return a.at < b.at; });
  return drive;
}

/// Sends the drive from now on, and returns when each row was sent.
std::vector<Moment> send(const std::vector<Sending>& drive) {
  take_priority(kSensorPriority);
  const transport::HostClock clock;
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  std::vector<Moment> sent;
  sent.reserve(drive.size());
  std::array<char, 256> row{};
  const Duration begin = monotonic_now() + std::chrono::milliseconds(10);
  for (const Sending& sending : drive) {
    const Duration at = begin + sending.at + (sending.is_row ? kRowDelay : Duration{});
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(at));
    std::span<const std::byte> payload = sending.payload;
    const Stamp stamp = clock.from_monotonic(begin + sending.at);
    if (sending.is_row) {
      const int length = std::snprintf(row.data(), row.size(), "%" PRId64 "%.*s", static_cast<std::int64_t>(stamp.time_since_epoch().count()),
                                       static_cast<int>(payload.size()), reinterpret_cast<const char*>(payload.data()));
      payload = std::as_bytes(std::span(row.data(), static_cast<std::size_t>(length)));
    }
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(sending.port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (sending.is_row) {
      sent.push_back({stamp, monotonic_now()});
    }
    if (sendto(fd, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) < 0) {
      throw_errno("sending to port " + std::to_string(sending.port));
    }
  }
  close(fd);
  return sent;
}

/// Takes poses from the bus until told to stop; room for `most`.
std::vector<Moment> hear(bool fifo, std::size_t pose_bytes, std::size_t most, const std::atomic<bool>& stopping) {
  if (fifo) {
    take_priority(kSubscriberPriority);
  }
  std::vector<Moment> heard;
  heard.reserve(most);
  const std::size_t expected_bytes = std::max(pose_bytes, kPose_bytes);
  bool all_as_large = true;
  bus::Connection connection("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304");
  connection.subscribe("BENCH_POSE", [&](std::span<const std::byte> bytes) {
    const Duration instant = monotonic_now();
    all_as_large = all_as_large && bytes.size() == expected_bytes;
    if (const auto pose = bus::decode_pose(bytes.first(std::min(bytes.size(), kPose_bytes))); pose && heard.size() < most) {
      heard.push_back({pose->stamp, instant});
    }
  });
  while (!stopping.load(std::memory_order_relaxed)) {
    connection.wait(std::chrono::milliseconds(50));
  }
  if (!all_as_large) {
    throw std::runtime_error("a pose message has not " + std::to_string(expected_bytes) + " bytes: the padding is not loaded");
  }
  return heard;
}

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The daemon, running.
class Daemon {
 public:
  Daemon(const PoseLatencyConfig& config, const fs::path& folder, bool fifo) : log_(folder / "slamd.log"), child_([&] { run(config, folder, fifo); }) {
    const Duration patience = monotonic_now() + std::chrono::seconds(10);
    while (text_of(log_).find("listening for") == std::string::npos) {
      if (monotonic_now() > patience) {
        throw std::runtime_error("slamd does not start: " + text_of(log_));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    if (fifo && text_of(log_).find("SCHED_FIFO is not permitted") != std::string::npos) {
      throw std::runtime_error("SCHED_FIFO is not permitted to slamd, so there is nothing to compare");
    }
  }

  void end() {
    if (child_.end(SIGTERM) != 0) {
      throw std::runtime_error("slamd did not end well: " + text_of(log_));
    }
  }

 private:
  void run(const PoseLatencyConfig& config, const fs::path& folder, bool fifo) const {
    const int log = open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(log, STDERR_FILENO);
    setenv("LD_PRELOAD", config.padding.c_str(), 1);
    setenv("SLAMD_POSE_BYTES", std::to_string(config.pose_bytes).c_str(), 1);
    const std::string toml = folder / "slamd.toml";
    const char* scheduling = fifo ? "realtime.fifo=true" : "realtime.fifo=false";
    execl(config.slamd.c_str(), config.slamd.c_str(), "--config", toml.c_str(), "--set", scheduling, nullptr);
    std::perror(config.slamd.c_str());
  }

  fs::path log_;
  Child child_;
};

PoseLatencyRow measure(const PoseLatencyConfig& config, const fs::path& folder, const std::vector<Sending>& drive, int hogs, bool fifo) {
  fs::remove(folder / "slamd.log");
  Daemon daemon(config, folder, fifo);
  std::vector<std::unique_ptr<Child>> hogging;
  for (int i = 0; i < hogs; ++i) {
    hogging.push_back(std::make_unique<Child>([] {
      for (volatile std::uint64_t work = 0;;) {
        work = work + 1;
      }
    }));
  }
  std::atomic<bool> stopping{false};
  std::vector<Moment> sent;
  std::vector<Moment> heard;
  std::exception_ptr fault;
  std::thread subscriber([&] {
    try {
      heard = hear(fifo, config.pose_bytes, 2 * drive.size(), stopping);
    } catch (...) {
      fault = std::current_exception();
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::exception_ptr sender_fault;
  std::thread sensor([&] {
    try {
      sent = send(drive);
    } catch (...) {
      sender_fault = std::current_exception();
    }
  });
  sensor.join();
  std::this_thread::sleep_for(std::chrono::seconds(1));
  stopping = true;
  subscriber.join();
  for (const std::exception_ptr& error : {fault, sender_fault}) {
    if (error) {
      std::rethrow_exception(error);
    }
  }
  hogging.clear();
  daemon.end();
  PoseLatencyRow row = row_of(sent, heard);
  row.hogs = hogs;
  row.fifo = fifo;
  if (row.heard == 0) {
    throw std::runtime_error("no pose was heard: " + text_of(folder / "slamd.log"));
  }
  return row;
}

void write_configuration(const fs::path& file) {
  std::ofstream(file) << "[[lidar]]\nmodel = \"vlp16\"\nbind_address = \"127.0.0.1\"\n"
                         "T_base_lidar = { xyz_m = [0.12, 0.0, 0.26], rpy_deg = [0.0, 0.0, 0.0] }\n"
                         "[imu]\nsource = \"udp\"\nclock = \"shared\"\nport = "
                      << kImuPort << "\n[lcm]\nprefix = \"BENCH\"\n";
}

}  // namespace

std::vector<PoseLatencyRow> measure_pose_latency(const PoseLatencyConfig& config, const std::function<void(double share)>& progress) {
  const Folder folder;
  simulate::Drive drive;
  drive.seed = 21;
  drive.duration_s = config.seconds;
  drive.rest_s = 1.5;
  drive.imu_rate_hz = config.imu_rate_hz;
  simulate::simulate(drive, folder.path(), nullptr);
  write_configuration(folder.path() / "slamd.toml");
  const std::vector<Sending> sendings = read_drive(folder.path());
  std::vector<PoseLatencyRow> rows;
  for (const int hogs : {0, config.hogs}) {
    for (const bool fifo : {true, false}) {
      progress(static_cast<double>(rows.size()) / 4.0);
      rows.push_back(measure(config, folder.path(), sendings, hogs, fifo));
    }
  }
  return rows;
}

}  // namespace slamd::bench
