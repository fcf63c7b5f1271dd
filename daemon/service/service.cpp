#include "daemon/service/service.hpp"

#include <algorithm>
#include <cctype>
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
#include <sys/mman.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "core/geometry/so3.hpp"
#include "daemon/bus/command_listener.hpp"
#include "daemon/devices/livox_device.hpp"
#include "daemon/pipeline/health_monitor.hpp"
#include "daemon/pipeline/pipeline.hpp"
#include "daemon/service/life_watch.hpp"
#include "daemon/service/log.hpp"
#include "daemon/service/map_saver.hpp"
#include "daemon/service/notifier.hpp"
#include "daemon/service/reload.hpp"
#include "daemon/service/repeat_limit.hpp"

namespace slamd::service {

using configuration::Configuration;

namespace {

constexpr Duration kHealthPeriod = std::chrono::milliseconds(500);
constexpr int kHousekeepingPeriod_ms = 100;

/// At most so often the manager is told what there is to see, and at least so often.
constexpr Duration kStatusPeriod = std::chrono::seconds(1);
constexpr Duration kStatusAgain = std::chrono::seconds(10);
/// A map is written by housekeeping, and a disk may keep it waiting for so long.
constexpr Duration kSavePatience = std::chrono::seconds(60);

/// SIGTERM, SIGINT and SIGHUP as something to poll, blocked in all threads that are made afterwards. At a terminal SIGHUP
/// ends the program, as everywhere: whoever started it has gone.
class Signals {
 public:
  Signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    if (isatty(STDIN_FILENO) == 0) {
      sigaddset(&set, SIGHUP);
    }
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

void log_counts(Log& log, const char* what, const stages::NamedCounts& counts) {
  std::string text;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
  }
  log.info(std::string(what) + ": " + text);
}

/// The same words, whatever numbers they carry.
std::string without_numbers(std::string words) {
  words.erase(std::remove_if(words.begin(), words.end(), [](unsigned char c) { return std::isdigit(c) != 0; }), words.end());
  return words;
}

/// What systemctl status shows: "DEGRADED: imu: silent for 1.2 s".
std::string status_of(const bus::Health& health) {
  std::string words = bus::name_of(health.state);
  const char* separator = ": ";
  for (const auto& cause : health.causes) {
    words += separator + std::string(cause.view());
    separator = "; ";
  }
  return words;
}

/// What an event is about, for the journal.
Fields fields_of(const char* thread, const threads::EventRecord& record) {
  Fields fields{{"SLAMD_THREAD", thread}};
  if (record.event == threads::Event::kStateChanged) {
    fields.emplace_back("SLAMD_STATE", odometry::name_of(static_cast<odometry::State>(record.value / 256)));
    fields.emplace_back("SLAMD_CAUSE", odometry::name_of(static_cast<odometry::Cause>(record.value % 256)));
  }
  return fields;
}

std::unique_ptr<devices::LivoxDevice> device_of(const Configuration& configuration) {
  return configuration.lidar.device.is_kept() ? std::make_unique<devices::LivoxDevice>(configuration) : nullptr;
}

/// What housekeeping does while the threads run.
class Housekeeping {
 public:
  Housekeeping(const Configuration& configuration, const transport::HostClock& clock, pipeline::Pipeline& pipeline, Log& log, Notifier& notifier)
      : configuration_(configuration),
        clock_(clock),
        pipeline_(pipeline),
        log_(log),
        notifier_(notifier),
        watchdog_(notifier.patience()),
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
      say(pipeline::cause_of(record), std::string(thread) + ": " + pipeline::sentence(record), now, fields_of(thread, record));
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
      notifier_.set_patience(watchdog_);
    }
    tell_repeated(now, false);
    if (now - last_health_ >= kHealthPeriod) {
      last_health_ = now;
      tell_health(now);
    }
  }

  /// Feeds the manager's watchdog while everything goes on, and says what does not.
  void watch() {
    const Stamp now = clock_.now();
    std::vector<Pulse> pulses;
    for (const auto& heartbeat : pipeline_.heartbeats()) {
      pulses.push_back({heartbeat->name, heartbeat->may_block, heartbeat->rounds.value()});
    }
    const pipeline::PublishCounts poses = pipeline_.publish().counts();
    const std::uint64_t inputs = configuration_.imu.enabled ? pipeline_.receive().counts().imu.received : pipeline_.odometry().counts().scans;
    life_.look(pulses, {inputs, poses.poses, poses.poses > 0 && poses.epoch == pipeline_.epoch()}, now);
    if (life_.fault() != fault_) {
      tell_fault(now);
    }
    if (life_.lives() && watchdog_ != Duration::zero() && now - last_fed_ >= watchdog_ / 4) {
      last_fed_ = now;
      notifier_.feed();
    }
  }

  /// Takes over what may change of a configuration that was read again, and says what may not.
  void reload(const std::function<Configuration()>& read_again) {
    notifier_.reloading();
    const configuration::RealtimeConfiguration before = configuration_.realtime;
    try {
      const Reload reload = take_over(configuration_, read_again());
      limit_.set_period(configuration_.log.repeat_period);
      saver_.set_directory(configuration_.output.save_directory);
      const bool scheduled = pipeline_.schedule(configuration_.realtime);
      waits_ = reload.refused.empty() ? "" : "configuration: waits for a restart: " + reload.refused.front();
      log_.write(reload.refused.empty() ? Level::kInfo : Level::kWarning, in_words(reload));
      if (!scheduled) {
        log_.warn("SCHED_FIFO with priority " + std::to_string(configuration_.realtime.priority) + " is not permitted: the threads run as before");
        configuration_.realtime = before;
      }
    } catch (const configuration::ConfigurationError& error) {
      waits_ = std::string("configuration refused: ") + error.what();
      log_.write(Level::kError, std::string("configuration refused, nothing has changed: ") + error.what());
    }
    status_ = {};
    notifier_.ready();
  }

  /// Writes what is left to say, after the threads have ended.
  void finish() {
    run_once();
    tell_repeated(clock_.now(), true);
  }

  /// Lets the LiDAR go.
  void release_device() {
    if (device_) {
      device_->stop([&](const std::string& cause, const std::string& sentence) { say(cause, sentence, clock_.now()); });
    }
  }

 private:
  void tell_health(Stamp now) {
    bus::Health health = health_.read(pipeline_, now, device_ ? device_->cause() : std::string());
    if (!waits_.empty()) {
      health.causes.try_push_back(bus::Text<79>(std::string_view(waits_)));
    }
    pipeline_.publisher().publish(health);
    const std::string words = status_of(health);
    const bool news = without_numbers(words) != without_numbers(status_);
    if (now - last_status_ >= (news ? kStatusPeriod : kStatusAgain)) {
      last_status_ = now;
      status_ = words;
      notifier_.status(words);
    }
  }

  void tell_fault(Stamp now) {
    fault_ = life_.fault();
    const bool ends = watchdog_ != Duration::zero() && !fault_.empty();
    const std::string words = fault_.empty() ? "everything goes on again" : fault_ + (ends ? ": the service manager will restart slamd" : "");
    log_.write(fault_.empty() ? Level::kWarning : Level::kError, words, {{"SLAMD_FAULT", fault_}});
    notifier_.status(words);
    last_status_ = now;
    status_.clear();
  }

  /// Writes a message, but repetitions of its cause only by their number.
  void say(const std::string& cause, const std::string& message, Stamp now, const Fields& fields = {}) {
    if (limit_.admit(cause, message, now)) {
      log_.write(Level::kInfo, message, fields);
    }
  }

  void tell_repeated(Stamp now, bool all) {
    limit_.tell(now, all, [&](const std::string& message, std::uint64_t more) {
      const auto period_s = std::to_string(std::lround(to_seconds(limit_.period())));
      log_.write(Level::kInfo, message + " (" + std::to_string(more) + " more in the last " + period_s + " s)", {{"SLAMD_REPEATED", std::to_string(more)}});
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
      const std::string fault = saver_.begin(command.id, command.arguments[0], placement_.T_map_corrected());
      if (fault.empty()) {
        if (life_.lives()) {  // or each save would postpone the restart that a hung thread needs
          notifier_.set_patience(std::max(watchdog_, kSavePatience));
        }
        return std::nullopt;
      }
      return bus::Reply{command.id, false, "save: " + fault};
    }
    // Said rather than pretended: it needs a part that this release does not have.
    return bus::Reply{command.id, false, command.verb + ": this release has no black box yet (see CHANGELOG)"};
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
    const geometry::Se3 T_odom_base(geometry::rotation_from_rpy({0.0, 0.0, pose.yaw_rad}), Eigen::Vector3d(pose.x_m, pose.y_m, pose.z_m));
    const geometry::Se3 T_corrected_base = pipeline_.correction().T_corrected_odom(pipeline_.epoch()) * T_odom_base;
    placement_.yaw_rad = yaw_rad - geometry::rpy_from_rotation(T_corrected_base.rotation()).z();
    const Eigen::Vector3d turned = geometry::rotation_from_rpy({0.0, 0.0, placement_.yaw_rad}) * T_corrected_base.translation();
    placement_.x_m = x_m - turned.x();
    placement_.y_m = y_m - turned.y();
    placement_.z_m = z_m - turned.z();
    ++placement_.correction_id;
    placement_.cause = bus::Correction::kCommand;
    pipeline_.place(placement_);
    return "map placed, correction " + std::to_string(placement_.correction_id + pipeline_.correction().correction_id);
  }

  Configuration configuration_;  // as in effect: reload() changes it
  transport::HostClock clock_;
  pipeline::Pipeline& pipeline_;
  Log& log_;
  Notifier& notifier_;
  Duration watchdog_;  // the manager's patience; zero: for ever
  LifeWatch life_;
  std::string fault_;   // as said last
  std::string waits_;   // what the last reload has left undone, for health
  std::string status_;  // as told last
  Stamp last_status_{};
  Stamp last_fed_{};
  pipeline::HealthMonitor health_;
  std::unique_ptr<devices::LivoxDevice> device_;  // nullptr: somebody else has it send here
  bus::CommandListener commands_;
  pipeline::MapPlacement placement_;
  MapSaver saver_;
  RepeatLimit limit_;
  Stamp last_health_{};
};

void lock_memory(const Configuration& configuration, Log& log) {
  if (configuration.realtime.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    log.warn(std::string("memory cannot be locked (") + std::strerror(errno) + "): page faults may delay poses; LimitMEMLOCK=infinity cures it");
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

int serve(const Configuration& configuration, const std::function<Configuration()>& read_again) {
  Log log;
  Notifier notifier;
  Signals signals;
  const transport::HostClock clock;
  pipeline::Pipeline pipeline(configuration, clock);
  Housekeeping housekeeping(configuration, clock, pipeline, log, notifier);
  if (const std::string remark = pipeline.receive().buffer_remark(); !remark.empty()) {
    log.warn(remark);
  }
  lock_memory(configuration, log);
  pipeline.start();
  if (configuration.realtime.fifo && !pipeline.is_fifo()) {
    log.warn("SCHED_FIFO is not permitted: other programs may delay poses; LimitRTPRIO=93 cures it");
  }
  if (const std::string& source = configuration.gnss.source; !source.empty() && pipeline.gnss_counts().empty()) {
    log.info("gnss.source = \"" + source + "\": a file is for slamd-replay; slamd takes serial or velodyne");
  }
  log.info(std::string("listening for ") + name_of(configuration.lidar.model) + ", telling " + configuration.lcm.url + " as " + configuration.lcm.prefix);
  notifier.ready();

  std::vector<pollfd> fds{{signals.fd(), POLLIN, 0}};
  for (const int fd : housekeeping.fds()) {
    fds.push_back({fd, POLLIN, 0});
  }
  int signal = 0;
  while (signal == 0) {
    poll(fds.data(), fds.size(), kHousekeepingPeriod_ms);
    housekeeping.run_once();
    housekeeping.watch();
    signal = signals.read();
    if (signal == SIGHUP) {
      housekeeping.reload(read_again);
      signal = 0;
    }
  }
  log.info(std::string("ending on ") + (signal == SIGINT ? "SIGINT" : "SIGTERM"));
  notifier.stopping();
  housekeeping.release_device();
  pipeline.stop();
  housekeeping.finish();
  log_counts(log, "packets", pipeline.receive().packets());
  const auto log_if_any = [&](const char* what, const stages::NamedCounts& counts) {
    if (!counts.empty()) {
      log_counts(log, what, counts);
    }
  };
  log_if_any("inertial", pipeline.receive().inertial());
  log_if_any("gnss", pipeline.gnss_counts());
  log_if_any("wheels", pipeline.wheels());
  log_if_any("can", pipeline.receive().can_frames());
  log_counts(log, "blocks", stages::named_counts(pipeline.preprocess().assembler_counts()));
  for (const std::string& remark : pipeline.receive().remarks()) {
    log.info(remark);
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
    std::printf("realtime   SCHED_FIFO is not permitted to this user (LimitRTPRIO=93 cures it)\n");
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
