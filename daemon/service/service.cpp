#include "daemon/service/service.hpp"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "core/geometry/so3.hpp"
#include "daemon/bus/command_listener.hpp"
#include "daemon/devices/livox_device.hpp"
#include "daemon/pipeline/health_monitor.hpp"
#include "daemon/pipeline/pipeline.hpp"
#include "daemon/service/map_saver.hpp"
#include "daemon/service/repeat_limit.hpp"

namespace slamd::service {

using configuration::Configuration;

namespace {

constexpr Duration kHealthPeriod = std::chrono::milliseconds(500);
constexpr int kHousekeepingPeriod_ms = 100;

/// SIGTERM and SIGINT as something to poll, blocked in all threads that are made afterwards.
class Signals {
 public:
  Signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    fd_ = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    signal(SIGPIPE, SIG_IGN);
  }
  ~Signals() { close(fd_); }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  int fd() const { return fd_; }

  /// The signal that came, or 0.
  int read() {
    signalfd_siginfo info{};
    return ::read(fd_, &info, sizeof info) == static_cast<ssize_t>(sizeof info) ? static_cast<int>(info.ssi_signo) : 0;
  }

 private:
  int fd_ = -1;
};

void log_counts(const char* what, const stages::NamedCounts& counts) {
  std::string text;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
  }
  spdlog::info("{}: {}", what, text);
}

std::unique_ptr<devices::LivoxDevice> device_of(const Configuration& configuration) {
  return configuration.lidar.device.is_kept() ? std::make_unique<devices::LivoxDevice>(configuration) : nullptr;
}

/// What housekeeping does while the threads run.
class Housekeeping {
 public:
  Housekeeping(const Configuration& configuration, const transport::HostClock& clock, pipeline::Pipeline& pipeline)
      : clock_(clock),
        pipeline_(pipeline),
        health_(configuration, clock.now()),
        device_(device_of(configuration)),
        commands_(configuration.lcm.url, configuration.lcm.prefix),
        saver_(configuration.output.save_directory, pipeline),
        limit_(configuration.log.repeat_period) {}

  /// What run_once() waits for.
  std::vector<int> fds() const {
    std::vector<int> fds = device_ ? device_->fds() : std::vector<int>{};
    fds.push_back(commands_.fd());
    return fds;
  }

  void run_once() {
    const Stamp now = clock_.now();
    pipeline_.read_events([&](const char* thread, const threads::EventRecord& record) {
      say(pipeline::cause_of(record), std::string(thread) + ": " + pipeline::sentence(record), now);
    });
    pipeline_.attend_can([&](const std::string& interface, const char* words) {
      say(interface + words, interface + ": " + words, now);
    });
    if (device_) {
      device_->run_once(now, pipeline_.receive().counts().lidar.last,
                        [&](const std::string& cause, const std::string& sentence) { say(cause, sentence, now); });
      device_->tell_time(pipeline_.gnss().newest, now);
      pipeline_.set_device(device_->address());
    }
    while (const auto command = commands_.poll(std::chrono::steady_clock::now())) {
      say(command->verb, "command " + command->verb, now);
      if (const auto reply = answer(*command)) {
        send(*reply);
      }
    }
    if (const auto reply = saver_.run_once()) {
      send(*reply);
    }
    tell_repeated(now, false);
    if (now - last_health_ >= kHealthPeriod) {
      last_health_ = now;
      pipeline_.publisher().publish(health_.read(pipeline_, now, device_ ? device_->cause() : std::string()));
    }
  }

  /// Writes what was held back, at the end.
  void finish() { tell_repeated(clock_.now(), true); }

  /// Lets the LiDAR go.
  void release_device() {
    if (device_) {
      device_->stop([&](const std::string& cause, const std::string& sentence) { say(cause, sentence, clock_.now()); });
    }
  }

 private:
  /// Writes a message, but repetitions of its cause only by their number.
  void say(const std::string& cause, const std::string& message, Stamp now) {
    if (limit_.admit(cause, message, now)) {
      spdlog::info("{}", message);
    }
  }

  void tell_repeated(Stamp now, bool all) {
    limit_.tell(now, all, [&](const std::string& message, std::uint64_t more) {
      spdlog::info("{} ({} more in the last {:.0f} s)", message, more, to_seconds(limit_.period()));
    });
  }

  void send(const bus::Reply& reply) {
    say(reply.ok ? "reply" : "refusal", (reply.ok ? "" : "refused: ") + reply.text, clock_.now());
    commands_.answer(reply);
  }

  /// The reply; nothing when it comes later.
  std::optional<bus::Reply> answer(const bus::Command& command) {
    if (command.verb == "set-pose") {
      if (pipeline_.publish().counts().epoch != pipeline_.epoch()) {
        return bus::Reply{command.id, false, "set-pose: there is no pose yet"};
      }
      return bus::Reply{command.id, true, set_pose(command)};
    }
    if (command.verb == "new-map") {
      if (saver_.is_busy()) {
        return bus::Reply{command.id, false, "new-map: the map is being saved"};
      }
      return bus::Reply{command.id, true, new_map()};
    }
    if (command.verb == "save") {
      const std::string fault = saver_.begin(command.id, command.arguments[0], T_map_odom());
      return fault.empty() ? std::nullopt : std::optional(bus::Reply{command.id, false, "save: " + fault});
    }
    // Said rather than pretended: it needs a part that this release does not have.
    return bus::Reply{command.id, false, command.verb + ": this release has no black box yet (see CHANGELOG)"};
  }

  geometry::Se3 T_map_odom() const {
    return {geometry::rotation_from_rpy({0.0, 0.0, placement_.yaw_rad}), Eigen::Vector3d(placement_.x_m, placement_.y_m, placement_.z_m)};
  }

  /// Forgets odom and its map; map begins where the next odom does.
  std::string new_map() {
    const std::uint32_t epoch = pipeline_.begin_epoch();
    placement_ = pipeline::MapPlacement{.correction_id = placement_.correction_id + 1, .cause = bus::Correction::kCommand};
    pipeline_.place(placement_);
    return "map " + std::to_string(epoch) + " begins as soon as odom is level";
  }

  /// Places odom so that base is where the command says; its arguments were checked by the listener.
  std::string set_pose(const bus::Command& command) {
    const double x_m = std::stod(command.arguments[0]);
    const double y_m = std::stod(command.arguments[1]);
    const double z_m = std::stod(command.arguments[2]);
    const double yaw_rad = std::stod(command.arguments[3]) * M_PI / 180.0;
    const pipeline::PublishCounts pose = pipeline_.publish().counts();
    placement_.yaw_rad = yaw_rad - pose.yaw_rad;
    const double c = std::cos(placement_.yaw_rad);
    const double s = std::sin(placement_.yaw_rad);
    placement_.x_m = x_m - (c * pose.x_m - s * pose.y_m);
    placement_.y_m = y_m - (s * pose.x_m + c * pose.y_m);
    placement_.z_m = z_m - pose.z_m;
    ++placement_.correction_id;
    placement_.cause = bus::Correction::kCommand;
    pipeline_.place(placement_);
    return "map placed, correction " + std::to_string(placement_.correction_id);
  }

  transport::HostClock clock_;
  pipeline::Pipeline& pipeline_;
  pipeline::HealthMonitor health_;
  std::unique_ptr<devices::LivoxDevice> device_;  // nullptr: somebody else has it send here
  bus::CommandListener commands_;
  pipeline::MapPlacement placement_;
  MapSaver saver_;
  RepeatLimit limit_;
  Stamp last_health_{};
};

void lock_memory(const Configuration& configuration) {
  if (configuration.realtime.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    spdlog::warn("memory cannot be locked ({}): page faults may delay poses; LimitMEMLOCK=infinity cures it", std::strerror(errno));
  }
}

bool may_use_fifo(int priority) {
  sched_param old{};
  const int policy = sched_getscheduler(0);
  sched_getparam(0, &old);
  sched_param parameters{};
  parameters.sched_priority = priority;
  const bool may = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  sched_setscheduler(0, policy, &old);
  return may;
}

}  // namespace

int serve(const Configuration& configuration) {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("slamd", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_pattern("%L %v");  // journald has the time
  spdlog::flush_on(spdlog::level::info);
  Signals signals;
  const transport::HostClock clock;
  pipeline::Pipeline pipeline(configuration, clock);
  Housekeeping housekeeping(configuration, clock, pipeline);
  if (const std::string remark = pipeline.receive().buffer_remark(); !remark.empty()) {
    spdlog::warn("{}", remark);
  }
  lock_memory(configuration);
  pipeline.start();
  if (configuration.realtime.fifo && !pipeline.is_fifo()) {
    spdlog::warn("SCHED_FIFO is not permitted: other programs may delay poses; LimitRTPRIO=90 cures it");
  }
  if (const std::string& source = configuration.gnss.source; !source.empty() && pipeline.gnss_counts().empty()) {
    spdlog::info("gnss.source = \"{}\": a file is for slamd-replay; slamd takes serial or velodyne", source);
  }
  spdlog::info("listening for {}, telling {} as {}", name_of(configuration.lidar.model), configuration.lcm.url, configuration.lcm.prefix);

  std::vector<pollfd> fds{{signals.fd(), POLLIN, 0}};
  for (const int fd : housekeeping.fds()) {
    fds.push_back({fd, POLLIN, 0});
  }
  int signal = 0;
  while (signal == 0) {
    poll(fds.data(), fds.size(), kHousekeepingPeriod_ms);
    housekeeping.run_once();
    signal = signals.read();
  }
  spdlog::info("ending on {}", signal == SIGINT ? "SIGINT" : "SIGTERM");
  housekeeping.release_device();
  pipeline.stop();
  housekeeping.run_once();
  housekeeping.finish();
  log_counts("packets", pipeline.receive().packets());
  const auto log_if_any = [](const char* what, const stages::NamedCounts& counts) {
    if (!counts.empty()) {
      log_counts(what, counts);
    }
  };
  log_if_any("inertial", pipeline.receive().inertial());
  log_if_any("gnss", pipeline.gnss_counts());
  log_if_any("wheels", pipeline.wheels());
  log_if_any("can", pipeline.receive().can_frames());
  log_counts("blocks", stages::named_counts(pipeline.preprocess().assembler_counts()));
  for (const std::string& remark : pipeline.receive().remarks()) {
    spdlog::info("{}", remark);
  }
  return 0;
}

int check(const Configuration& configuration) {
  const transport::HostClock clock;
  try {
    const pipeline::Pipeline pipeline(configuration, clock);
    const std::unique_ptr<devices::LivoxDevice> device = device_of(configuration);
    std::printf("sockets    bound\nbus        %s, channels %s_*\n", configuration.lcm.url.c_str(), configuration.lcm.prefix.c_str());
    if (const pipeline::CanInput* can = pipeline.receive().can(); can != nullptr) {
      for (std::size_t i = 0; i < can->size(); ++i) {
        std::printf("can        %s %s\n", can->socket(i).interface().c_str(), in_words(can->socket(i).link()));
      }
    }
    if (const std::string remark = pipeline.receive().buffer_remark(); !remark.empty()) {
      std::printf("buffers    %s\n", remark.c_str());
    }
  } catch (const std::runtime_error& error) {
    std::printf("cannot start: %s\n", error.what());
    return 1;
  }
  if (configuration.lcm.url.find("ttl=0") != std::string::npos) {
    std::printf("bus        ttl=0: only programs on this computer will hear slamd\n");
  }
  if (configuration.realtime.fifo && !may_use_fifo(configuration.realtime.priority)) {
    std::printf("realtime   SCHED_FIFO is not permitted to this user (LimitRTPRIO=90 cures it)\n");
  }
  std::printf("ready\n");
  return 0;
}

std::string memory_plan_text(const Configuration& configuration) {
  std::string text;
  double sum_bytes = 0.0;
  char line[128];
  for (const pipeline::MemoryItem& item : pipeline::memory_plan(configuration)) {
    const double bytes = static_cast<double>(item.count) * static_cast<double>(item.item_bytes);
    sum_bytes += bytes;
    std::snprintf(line, sizeof line, "%-34s %9zu x %8zu B %9.2f MB\n", item.name.c_str(), item.count, item.item_bytes, 1e-6 * bytes);
    text += line;
  }
  std::snprintf(line, sizeof line, "%-34s %9s   %8s   %9.2f MB\n", "sum", "", "", 1e-6 * sum_bytes);
  return text + line;
}

}  // namespace slamd::service
