#include "tools/simulate/live_drive.hpp"

#include <array>
#include <cmath>
#include <future>
#include <optional>

#include <nlohmann/json.hpp>

#include "daemon/bus/channels.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/encoding.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "tools/simulate/fault_injector.hpp"
#include "tools/simulate/live_can.hpp"
#include "tools/simulate/simulate.hpp"
#include "tools/simulate/simulated_source.hpp"

namespace slamd::simulate {

namespace {

/// The newest velocity command from LCM, as long as it holds.
class CommandInbox {
 public:
  CommandInbox(bus::Connection& connection, const bus::Channels& channels, replay::SendClock& clock)
      : connection_(connection), clock_(clock) {
    connection.subscribe(channels.velocity_command, [this](std::span<const std::byte> message) {
      if (const auto command = bus::decode_velocity_command(message)) {
        newest_ = {command->v_mps, command->w_radps};
        heard_ = clock_.now();
        ++commands_;
      } else {
        ++malformed_;
      }
    });
  }

  Velocity newest() {
    while (connection_.wait(std::chrono::milliseconds(0))) {
    }
    return heard_ && clock_.now() - *heard_ <= bus::kCommandHolds ? newest_ : Velocity{};
  }

  std::uint64_t commands() const { return commands_; }
  std::uint64_t malformed() const { return malformed_; }

 private:
  bus::Connection& connection_;
  replay::SendClock& clock_;
  Velocity newest_;
  std::optional<Duration> heard_;
  std::uint64_t commands_ = 0;
  std::uint64_t malformed_ = 0;
};

/// The files that grow with the drive.
class LiveRecording {
 public:
  LiveRecording(const Drive& drive, const std::filesystem::path& directory)
      : directory_(directory),
        packets_(directory / "lidar.pcap"),
        imu_(directory / "imu.csv"),
        commands_(directory / "commands.csv") {
    write_parameters(drive, directory);
    std::fprintf(commands_.stream(), "timestamp_ns,v_m_s,w_rad_s\n");
  }

  void write(const recording::Packet& packet) { packets_.write(packet, kHostAddress); }
  void write(const sensor::ImuSample& sample, double temp_c) { imu_.write(sample, temp_c); }

  /// Writes what was asked of the vehicle in a moment.
  void write(const Moment& moment) {
    const Stamp begin = stamp_at(moment.end_s - Motion::kKnot_s);
    std::fprintf(commands_.stream(), "%lld,%.4f,%.4f\n", static_cast<long long>(begin.time_since_epoch().count()),
                 moment.command.v_mps, moment.command.w_radps);
  }

  void close(const Scene& scene, FaultInjector* injector) {
    packets_.close();
    imu_.close();
    commands_.close();
    write_surroundings(scene, directory_);
    if (injector != nullptr) {
      write_faults(*scene.drive().faults, injector->counts(), directory_ / "faults.json");
    }
  }

 private:
  std::filesystem::path directory_;
  recording::PcapWriter packets_;
  ImuFile imu_;
  TextFile commands_;
};

/// Sends a moment's events to the network, to LCM and into the files, each at its time.
class Sender {
 public:
  Sender(replay::NetworkPlayer& player, bus::Connection& connection, const bus::Channels& channels,
         FaultInjector* injector, LiveRecording* recording, PacketOutlet* outlet, LiveCan* can)
      : player_(player),
        connection_(connection),
        channels_(channels),
        injector_(injector),
        recording_(recording),
        outlet_(outlet),
        can_(can) {}

  void send(const Moment& moment) {
    if (recording_ != nullptr) {
      recording_->write(moment);
    }
    std::size_t packet = 0;
    std::size_t row = 0;
    std::size_t wheels = 0;
    std::size_t truth = 0;
    std::size_t fix = 0;
    const auto before = [](const auto& list, std::size_t i, double t_s) { return i < list.size() && list[i].t_s <= t_s; };
    const auto send_until = [&](double t_s) {
      for (; before(moment.rows, row, t_s); ++row) {
        send(moment.rows[row]);
      }
      for (; before(moment.fixes, fix, t_s); ++fix) {
        send(moment.fixes[fix]);
      }
      for (; before(moment.wheels, wheels, t_s); ++wheels) {
        send(moment.wheels[wheels]);
      }
      if (can_ != nullptr) {
        can_->send_until(stamp_at(t_s), player_);
      }
      for (; before(moment.truths, truth, t_s); ++truth) {
        send(moment.truths[truth], moment.collisions);
      }
    };
    for (; packet < moment.packets.size() && !player_.interrupted(); ++packet) {
      send_until(moment.packets[packet].sent_s);
      send(moment.packets[packet]);
    }
    send_until(moment.end_s);
  }

  void finish() {
    if (injector_ != nullptr) {
      injector_->finish([this](const recording::Packet& packet) { hand_on(packet); });
    }
  }

 private:
  void hand_on(const recording::Packet& packet) {
    if (recording_ != nullptr) {
      recording_->write(packet);
    }
    if (outlet_ == nullptr) {
      player_.send(packet);
    } else if (player_.wait_until(packet.received)) {
      outlet_->send(packet.payload, player_.wall_minus_recorded());
    }
  }

  void send(const SentPacket& sent) {
    if (injector_ != nullptr) {
      injector_->add(packet_of(sent), [this](const recording::Packet& packet) { hand_on(packet); });
    } else {
      hand_on(packet_of(sent));
    }
  }

  void send(const Moment::Row& row) {
    sensor::ImuSample sample = written_sample(row.t_s, row.reading);
    if (injector_ != nullptr && !injector_->pass(sample)) {
      return;
    }
    if (recording_ != nullptr) {
      recording_->write(sample, row.reading.temp_c);
    }
    if (player_.takes_rows()) {
      player_.send(sample, stamp_at(row.t_s));
    }
    if (can_ != nullptr) {
      can_->add(sample);
    }
  }

  void send(const Moment::Wheels& wheels) {
    if (can_ != nullptr) {
      can_->add(wheels.reading, stamp_at(wheels.t_s));
    }
  }

  void send(const Moment::Fix& fix) {
    if (player_.takes_fixes()) {
      player_.send(fix_of(fix.reading), stamp_at(fix.t_s));
    }
  }

  void send(const Moment::Truth& truth, std::uint32_t collisions) {
    player_.wait_until(stamp_at(truth.t_s));
    const bus::Truth message{.stamp = stamp_at(truth.t_s) + player_.wall_minus_recorded(),
                             .T_world_base = truth.motion.T_world_base,
                             .v_world_base = truth.motion.velocity_mps,
                             .rate_base_radps = truth.motion.rate_base_radps,
                             .collisions = collisions};
    std::array<std::byte, bus::kLargestMessage_bytes> buffer;
    connection_.send(channels_.truth, {buffer.data(), bus::encode(message, buffer)});
  }

  replay::NetworkPlayer& player_;
  bus::Connection& connection_;
  const bus::Channels& channels_;
  FaultInjector* injector_;
  LiveRecording* recording_;
  PacketOutlet* outlet_;
  LiveCan* can_;
};

std::string collision_text(const Moment& moment) {
  const Eigen::Vector3d p =
      moment.truths.empty() ? Eigen::Vector3d::Zero() : moment.truths.back().motion.T_world_base.translation();
  char text[120];
  std::snprintf(text, sizeof text, "collision %u at %.1f s, near x %.1f y %.1f m: the vehicle stopped",
                moment.collisions, moment.end_s, p.x(), p.y());
  return text;
}

}  // namespace

LiveDrive::LiveDrive(const Drive& drive)
    : scene_(drive),
      vehicle_(scene_.world(), scene_.route(), ride_of(drive), start_of(scene_.route(), ride_of(drive), drive.seed),
               drive.seed),
      packets_(scene_, PacketStream::Drive::kGrowing),
      imu_(scene_.imu()),
      gnss_(scene_.motion(), scene_.mounting().T_base_antenna, kGnss_hz, drive.gnss_errors, drive.seed),
      wheels_(scene_.motion(), kWheel_hz, drive.wheel_errors, drive.seed) {}

Moment LiveDrive::next(const Velocity& command) {
  Moment moment;
  moment.command = command;
  const double vehicle_s = kDelay_s + Motion::kKnot_s * static_cast<double>(knots_++);
  const Motion::Channels point = vehicle_.advance(command, vehicle_s);
  scene_.extend(point, shake_of(std::abs(vehicle_.velocity().v_mps)));
  moment.end_s = scene_.motion().duration_s();
  moment.collisions = vehicle_.collisions();
  for (const SentPacket* packet = nullptr; packets_.next(packet);) {
    moment.packets.push_back(*packet);
  }
  double t_s = 0.0;
  for (InertialReading reading; imu_.next_s() <= scene_.known_s() && imu_.next(t_s, reading);) {
    moment.rows.push_back({t_s, reading});
  }
  for (GnssReading reading; gnss_.next_s() <= scene_.known_s() && gnss_.next(t_s, reading);) {
    moment.fixes.push_back({t_s, reading});
  }
  for (; static_cast<double>(wheel_readings_) / kWheel_hz <= scene_.known_s(); ++wheel_readings_) {
    WheelReading reading;
    wheels_.next(t_s, reading);
    moment.wheels.push_back({t_s, reading});
  }
  for (; static_cast<double>(truths_) / kTruth_hz <= scene_.known_s(); ++truths_) {
    t_s = static_cast<double>(truths_) / kTruth_hz;
    moment.truths.push_back({t_s, scene_.motion().at(t_s)});
  }
  return moment;
}

LiveReport drive_live(const Drive& drive, const LiveOptions& options, replay::SendClock& clock,
                      const std::function<bool()>& stopped, const std::function<void(double share)>& progress,
                      const std::function<void(const std::string&)>& say, PacketOutlet* outlet) {
  const bus::Channels channels(options.lcm_prefix);
  bus::Connection connection(options.lcm_url);
  CommandInbox inbox(connection, channels, clock);
  LiveDrive live(drive);
  const configuration::Configuration configuration = configuration_of(drive, {});
  replay::NetworkPlayer player(configuration.lidar, options.target, clock, stopped);
  std::optional<FaultInjector> injector;
  if (drive.faults) {
    injector.emplace(*drive.faults, drive.duration_s);
  }
  FaultInjector* const faulty = injector ? &*injector : nullptr;
  std::optional<LiveRecording> recording;
  if (!options.directory.empty()) {
    recording.emplace(drive, options.directory);
  }
  std::optional<LiveCan> can;
  if (!options.target.can_interface.empty()) {
    can.emplace(drive, options.target.can_interface, clock);
  }
  Sender sender(player, connection, channels, faulty, recording ? &*recording : nullptr, outlet, can ? &*can : nullptr);

  // One moment is simulated while the one before is sent.
  const auto simulate_next = [&] { return live.next(inbox.newest()); };
  player.wait_for_reader();
  std::future<Moment> next = std::async(std::launch::async, simulate_next);
  LiveReport report;
  while (report.driven_s < drive.duration_s && !player.interrupted()) {
    const Moment moment = next.get();
    next = std::async(std::launch::async, simulate_next);
    if (report.driven_s == 0.0) {
      player.begin(stamp_at(0.0));
    }
    if (moment.collisions != report.collisions) {
      report.collisions = moment.collisions;
      say(collision_text(moment));
    }
    sender.send(moment);
    report.driven_s = moment.end_s;
    progress(report.driven_s / drive.duration_s);
  }
  next.wait();
  sender.finish();
  report.sent = player.finish();
  report.sent.can_frames = can ? can->sent() : 0;
  report.path_m = live.scene().path_m();
  report.commands = inbox.commands();
  report.commands_malformed = inbox.malformed();
  if (recording) {
    recording->close(live.scene(), faulty);
  }
  return report;
}

std::string json_of(const LiveReport& report) {
  auto json = nlohmann::ordered_json::parse(json_of(report.sent));
  json["driven_s"] = report.driven_s;
  json["path_m"] = report.path_m;
  json["commands"] = {{"heard", report.commands}, {"malformed", report.commands_malformed}};
  json["collisions"] = report.collisions;
  if (report.device) {
    json["device"] = {{"sent", report.device->sent},
                      {"unwanted", report.device->unwanted},
                      {"utc", {{"told", report.device->utc_told}, {"unused", report.device->utc_unused}}}};
  }
  return json.dump(2) + "\n";
}

std::string summary_of(const LiveReport& report) {
  char text[200];
  std::snprintf(text, sizeof text, "drove %.1f s, %.1f m; heard %llu commands (and %llu malformed); %u collisions\n",
                report.driven_s, report.path_m, static_cast<unsigned long long>(report.commands),
                static_cast<unsigned long long>(report.commands_malformed), report.collisions);
  return text + replay::summary_of(report.sent);
}

}  // namespace slamd::simulate
