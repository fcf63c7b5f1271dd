#include "daemon/pipeline/health_monitor.hpp"

#include <algorithm>
#include <cstdio>
#include <system_error>

#include <net/if.h>

#include "core/calibration/words.hpp"
#include "daemon/stages/pose_stage.hpp"
#include "drivers/storage/session_keeper.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::pipeline {

using bus::SensorHealth;
using bus::SensorState;
using bus::TimeState;
using threads::Event;

namespace {

/// Receivers speak once a second.
constexpr Duration kGnssSilent = std::chrono::seconds(3);

std::string with_seconds(const char* pattern, Duration duration) {
  char text[96];
  std::snprintf(text, sizeof text, pattern, to_seconds(duration));
  return text;
}

float microseconds(Duration duration) { return static_cast<float>(1e6 * to_seconds(duration)); }

bus::StageHealth stage(const char* name, const threads::StageMonitor& monitor) {
  const threads::StageTime time = monitor.last_period();
  return {name, microseconds(time.p50), microseconds(time.p99), microseconds(time.max), static_cast<std::uint32_t>(time.count)};
}

template <typename Resource>
bus::PoolHealth pool_health(const char* name, const Resource& pool) {
  return {name, static_cast<std::uint32_t>(pool.size()), static_cast<std::uint32_t>(pool.low_water())};
}

bool hears(const SensorCounts& counts, Stamp now) { return counts.last != Stamp{} && now - counts.last < ReceiveLoop::kSilent; }

/// Packets have come again, but no scan of them: what the odometry said last is of before. Poses say it likewise.
bool waits_for_scan(const OdometryCounts& odometry, Stamp now) {
  return now - odometry.last > stages::PoseStage::kNoScan;
}

SensorState state_of(const SensorCounts& counts, Stamp now) {
  if (counts.last == Stamp{}) {
    return SensorState::kWaiting;
  }
  return hears(counts, now) ? SensorState::kRunning : SensorState::kSilent;
}

SensorHealth sensor_health(const std::string& name, const SensorCounts& counts, bool shared_clock, Stamp now) {
  SensorHealth health;
  health.name = std::string_view(name);
  health.state = state_of(counts, now);
  health.received = counts.received;
  health.dropped = counts.dropped;
  health.time_residual_us = microseconds(counts.clock_residual);
  health.time_skew_ppm = static_cast<float>(1e6 * counts.clock_skew);
  health.time_steps = static_cast<std::uint32_t>(counts.clock_steps);
  if (counts.last != Stamp{}) {
    health.time = shared_clock ? TimeState::kShared : TimeState::kLocked;
  }
  return health;
}

}  // namespace

HealthMonitor::HealthMonitor(const configuration::Configuration& configuration, Stamp started)
    : lidar_name_(name_of(configuration.lidar.model)),
      imu_enabled_(configuration.imu.enabled),
      wheels_enabled_(configuration.wheel.use && configuration.wheel.source == "can"),
      shared_clock_(configuration.lidar.clock == configuration::SensorClock::kShared),
      gnss_enabled_(configuration.gnss.is_serial() || configuration.gnss.is_velodyne()),
      imu_offset_s_(to_seconds(configuration.odometry.imu_offset)),
      T_base_imu_(resolved_odometry(configuration).T_base_imu),
      started_(started) {}

void HealthMonitor::Rate::update(std::uint64_t new_count, Stamp now) {
  constexpr Duration kPeriod = std::chrono::seconds(2);
  if (at == Stamp{} || now - at >= kPeriod) {
    hz = at == Stamp{} ? 0.0 : static_cast<double>(new_count - count) / to_seconds(now - at);
    count = new_count;
    at = now;
  }
}

SensorHealth HealthMonitor::lidar(const Pipeline& pipeline, Stamp now) {
  const ReceiveCounts receive = pipeline.receive().counts();
  const PreprocessCounts scans = pipeline.preprocess().counts();
  SensorHealth health = sensor_health(lidar_name_, receive.lidar, shared_clock_, now);
  health.lost = scans.blocks_missing;
  scans_.update(scans.scans, now);
  health.rate_hz = static_cast<float>(scans_.hz);
  return health;
}

SensorHealth HealthMonitor::imu(const Pipeline& pipeline, Stamp now) {
  const ReceiveCounts receive = pipeline.receive().counts();
  SensorHealth health = sensor_health("imu", receive.imu, shared_clock_, now);
  health.lost = receive.imu.kernel_lost + receive.imu.missing;
  health.dropped += pipeline.preprocess().counts().imu_refused;
  samples_.update(receive.imu.received, now);
  health.rate_hz = static_cast<float>(samples_.hz);
  return health;
}

SensorHealth HealthMonitor::gnss(const Pipeline& pipeline, Stamp now) {
  const stages::GnssState state = pipeline.gnss();
  SensorHealth health;
  health.name = "gnss";
  health.state = state.last_bytes == Stamp{} ? SensorState::kWaiting
                 : now - state.last_message < kGnssSilent ? SensorState::kRunning
                                                          : SensorState::kSilent;
  health.received = state.good;
  health.dropped = state.fixes - state.good + state.damaged;
  fixes_.update(state.good, now);
  health.rate_hz = static_cast<float>(fixes_.hz);
  return health;
}

std::string gnss_cause(const stages::GnssState& state, Stamp now) {
  if (state.last_bytes == Stamp{}) {
    return "gnss: no GNSS bytes yet";
  }
  if (now - state.last_bytes > kGnssSilent) {
    return with_seconds("gnss: no GNSS bytes for %.1f s", now - state.last_bytes);
  }
  if (now - state.last_message > kGnssSilent) {
    return "gnss: bytes arrive, but neither NMEA nor UBX: another rate?";
  }
  if (state.last_good == Stamp{}) {
    return "gnss: no fix yet, " + std::to_string(state.newest.satellites) + " satellites";
  }
  return now - state.last_good > kGnssSilent
             ? with_seconds("gnss: no fix for %.1f s", now - state.last_good) + ", " + std::to_string(state.newest.satellites) + " satellites"
             : "";
}

SensorHealth HealthMonitor::wheels(const Pipeline& pipeline, Stamp now) {
  const ReceiveCounts receive = pipeline.receive().counts();
  SensorHealth health = sensor_health("wheels", receive.wheels, true, now);
  health.lost = receive.wheels.kernel_lost;
  wheel_samples_.update(receive.wheels.received, now);
  health.rate_hz = static_cast<float>(wheel_samples_.hz);
  return health;
}

void HealthMonitor::add_causes(const Pipeline& pipeline, Stamp now, bus::Health& health) const {
  const auto say = [&](const std::string& words) { health.causes.try_push_back(bus::Text<79>(std::string_view(words))); };
  const ReceiveCounts receive = pipeline.receive().counts();
  const auto judge = [&](const std::string& name, const SensorCounts& counts) {
    if (counts.last == Stamp{}) {
      say(name + (counts.dropped > 0 ? ": packets arrive, but none is the sensor's" : ": nothing received yet"));
    } else if (!hears(counts, now)) {
      say(with_seconds((name + ": silent for %.1f s").c_str(), now - counts.last));
    }
  };
  if (const CanInput* can = pipeline.receive().can(); can != nullptr) {
    for (std::size_t i = 0; i < can->size(); ++i) {
      if (can->socket(i).link() != transport::CanLink::kUp) {
        say(can->socket(i).interface() + ": " + transport::in_words(can->socket(i).link()));
      }
    }
  }
  judge(lidar_name_, receive.lidar);
  if (imu_enabled_) {
    judge("imu", receive.imu);
    if (const std::string_view fault = imu::in_words(receive.imu_units); !fault.empty()) {
      say("imu: " + std::string(fault));
    }
  }
  if (wheels_enabled_) {
    judge("wheels", receive.wheels);
  }
  add_odometry_causes(pipeline, now, say);
  if (pipeline.mapping() != nullptr) {
    if (const std::string fault(pipeline.mapping()->counts().session_fault.view()); !fault.empty()) {
      say("session: " + fault);
    }
  }
  if (gnss_enabled_) {
    if (const std::string words = gnss_cause(pipeline.gnss(), now); !words.empty()) {
      say(words);  // last: nothing else depends on it
    }
  }
}

template <typename Say>
void HealthMonitor::add_odometry_causes(const Pipeline& pipeline, Stamp now, Say&& say) const {
  const ReceiveCounts receive = pipeline.receive().counts();
  const OdometryCounts odometry = pipeline.odometry().counts();
  if (odometry.epoch != pipeline.epoch()) {
    if (imu_enabled_ && !pipeline.preprocess().counts().aligned && receive.imu.last != Stamp{}) {
      say("imu: being levelled");
    }
    return;
  }
  if (odometry.cause != odometry::Cause::kNone) {
    say(odometry::in_words(odometry.cause, odometry.weak_axes_base));
  } else if (hears(receive.lidar, now) && waits_for_scan(odometry, now)) {
    say(odometry::name_of(odometry::Cause::kNoLidar));
  }
  for (const std::string& complaint : calibration::complaints(odometry.agreement, imu_offset_s_, T_base_imu_)) {
    say(complaint);
  }
}

bus::Health HealthMonitor::read(const Pipeline& pipeline, Stamp now, const std::string& device_cause) {
  bus::Health health;
  health.stamp = now;
  health.uptime = now - started_;
  const ReceiveCounts receive = pipeline.receive().counts();
  const PreprocessCounts preprocess = pipeline.preprocess().counts();
  const OdometryCounts odometry = pipeline.odometry().counts();
  health.sensors.push_back(lidar(pipeline, now));
  if (imu_enabled_) {
    health.sensors.push_back(imu(pipeline, now));
  }
  if (gnss_enabled_) {
    health.sensors.push_back(gnss(pipeline, now));
  }
  if (wheels_enabled_) {
    health.sensors.push_back(wheels(pipeline, now));
  }
  health.state = odometry.epoch == pipeline.epoch() ? static_cast<bus::State>(odometry.state) : bus::State::kStarting;
  const bool silent = !hears(receive.lidar, now) || (imu_enabled_ && !hears(receive.imu, now)) ||
                      (wheels_enabled_ && !hears(receive.wheels, now));
  if ((silent || waits_for_scan(odometry, now)) && health.state == bus::State::kTracking) {
    health.state = bus::State::kDegraded;
  }
  health.weak_axes = odometry.weak_axes;
  if (!device_cause.empty()) {
    health.causes.try_push_back(bus::Text<79>(std::string_view(lidar_name_ + ": " + device_cause)));
  }
  add_causes(pipeline, now, health);
  health.stages.push_back(stage("receive", pipeline.receive().monitor()));
  health.stages.push_back(stage("preprocess", pipeline.preprocess().monitor()));
  health.stages.push_back(stage("odometry", pipeline.odometry().monitor()));
  health.stages.push_back(stage("scan to pose", pipeline.publish().scan_monitor()));
  health.stages.push_back(stage("imu to pose", pipeline.publish().pose_monitor()));
  if (pipeline.mapping() != nullptr) {
    health.stages.push_back(stage("mapping", pipeline.mapping()->monitor()));
  }
  health.pools.push_back(pool_health("blocks", pipeline.rings().block_pool));
  health.pools.push_back(pool_health("scans", pipeline.rings().job_pool));
  const auto count = [&](const char* name, std::uint64_t value) { health.counters.try_push_back({name, value}); };
  count("poses", pipeline.publish().counts().poses);
  count("scans", odometry.scans);
  count("scans_skipped", odometry.skipped);
  count("scans_dropped", preprocess.scans_dropped);
  count("blocks_dropped", receive.blocks_dropped);
  count("kernel_lost", receive.lidar.kernel_lost + receive.imu.kernel_lost + receive.wheels.kernel_lost);
  count("imu_late", preprocess.imu_late);
  if (receive.samples_clipped != 0) {
    count("samples_clipped", receive.samples_clipped);
  }
  if (const CanInput* can = pipeline.receive().can(); can != nullptr) {
    const transport::CanCounters frames = can->counters();
    count("can_bus_off", frames.bus_off);
    count("can_controller_lost", frames.controller_lost);
  }
  count("resets", pipeline.publish().counts().reset_counter);
  if (gnss_enabled_) {
    const stages::GnssState state = pipeline.gnss();
    const bool fresh = state.last_message != Stamp{} && now - state.last_message < kGnssSilent;
    count("gnss_quality", fresh ? static_cast<std::uint64_t>(state.newest.quality) : 0);
    count("gnss_satellites", fresh ? state.newest.satellites : 0);
    if (state.last_good != Stamp{}) {
      count("gnss_age_ms", static_cast<std::uint64_t>(std::max(Duration{}, now - state.last_good) / std::chrono::milliseconds(1)));
    }
  }
  if (pipeline.mapping() != nullptr) {  // last: with CAN and a receiver there may be no room
    const MappingCounts mapping = pipeline.mapping()->counts();
    count("loops", mapping.accepted - mapping.removed);
    count("keyframes", mapping.keyframes);
    if (pipeline.publish().counts().scans_unmapped != 0) {
      count("scans_unmapped", pipeline.publish().counts().scans_unmapped);
    }
  }
  health.swarm_use = odometry.scans == 0 ? 0.0F
                                         : static_cast<float>(odometry.swarm_won) / static_cast<float>(odometry.scans);
  health.particles = odometry.particles;
  health.inlier_share = static_cast<float>(odometry.inlier_ratio);
  if (const calibration::LidarImuAgreement& agreement = odometry.agreement.lidar_imu; agreement.known) {
    health.imu_offset_ms = static_cast<float>(1e3 * agreement.offset_s.value);
    health.imu_offset_std_ms = static_cast<float>(1e3 * agreement.offset_s.std);
  }
  return health;
}

namespace {

/// The interface that an event of CAN is about.
std::string interface_of(const threads::EventRecord& record) {
  char name[IF_NAMESIZE];
  return if_indextoname(static_cast<unsigned>(record.value), name) != nullptr ? name : "CAN interface " + std::to_string(record.value);
}

}  // namespace

std::string cause_of(const threads::EventRecord& record) {
  const bool is_of_can = record.event >= Event::kCanBusOff && record.event <= Event::kCanKernelLost;
  const bool by_value = record.event == Event::kStateChanged || is_of_can;
  return "event " + std::to_string(static_cast<int>(record.event)) + (by_value ? " " + std::to_string(record.value) : "");
}

std::string sentence(const threads::EventRecord& record) {
  const auto number = std::to_string(record.value);
  switch (record.event) {
    case Event::kLidarHeard:
      return "the LiDAR is heard, from " + transport::dotted(static_cast<std::uint32_t>(record.value));
    case Event::kLidarSilent: return "the LiDAR has fallen silent";
    case Event::kImuHeard: return "the inertial sensor is heard";
    case Event::kImuSilent: return "the inertial sensor has fallen silent";
    case Event::kWheelsHeard: return "the wheels are heard";
    case Event::kWheelsSilent: return "the wheels have fallen silent";
    case Event::kCanBusOff: return interface_of(record) + ": bus off; nothing comes until it is restarted (ip link set type can restart-ms)";
    case Event::kCanRestarted: return interface_of(record) + ": restarted, on the bus again";
    case Event::kCanWarning: return interface_of(record) + ": many errors on the bus (warning level)";
    case Event::kCanPassive: return interface_of(record) + ": so many errors on the bus that the controller is error passive";
    case Event::kCanControllerLost: return interface_of(record) + ": the controller has lost frames, for its buffer was full";
    case Event::kCanKernelLost: return interface_of(record) + ": the kernel has lost frames, for the receive buffer was full";
    case Event::kSerialLost: return "the serial port is gone; it is tried again twice a second";
    case Event::kSerialOpen: return "the serial port is open";
    case Event::kSerialRefused:
      return "the serial port cannot be opened (" + std::generic_category().message(static_cast<int>(record.value)) +
             "); it is tried again twice a second";
    case Event::kSerialSilent: return "nothing comes from the serial port; it is opened anew";
    case Event::kSerialFound: return "the inertial sensor is heard at " + number + " baud";
    case Event::kImuConfigured: return "the inertial sensor is configured: " + number + " samples a second";
    case Event::kImuRefused: return "the inertial sensor refuses its configuration (code " + number + "), and goes on as it was";
    case Event::kImuTakenAsItIs: return "the inertial sensor does not answer, but sends: it is taken as it is";
    case Event::kImuMute: return "the inertial sensor neither sends nor answers; it is asked again";
    case Event::kGnssFound: return "the receiver is heard at " + number + " baud";
    case Event::kGnssFix: return "the receiver has a fix";
    case Event::kGnssNoFix: return "the receiver has no fix";
    case Event::kBlockPoolEmpty: return "no free block: " + number + " packets dropped so far";
    case Event::kScanDropped: return "no free job: " + number + " scans dropped so far";
    case Event::kScanSkipped: return "the odometry is late: " + number + " scans skipped so far";
    case Event::kImuLate: return number + " scans went on without their inertial samples so far";
    case Event::kStarted:
      return record.value == 2 ? "odometry begins, without inertial sensor"
                               : (record.value == 1 ? "levelled at rest; odometry begins" : "levelled in motion; odometry begins");
    case Event::kNewMap: return "a new map was ordered; odom is levelled anew";
    case Event::kStateChanged:
      return std::string(odometry::name_of(static_cast<odometry::State>(record.value / 256))) + ": " +
             odometry::name_of(static_cast<odometry::Cause>(record.value % 256));
    case Event::kMapCorrected: return "the map was corrected by loops (correction " + number + ")";
    case Event::kLoopRemoved: return "loop " + number + " does not agree with the others, and counts no more";
    case Event::kSessionBegun:
      return "the map is kept as " + storage::session_name(Stamp(std::chrono::seconds(static_cast<std::int64_t>(record.value)))) + " in mapping.session_directory";
    case Event::kSessionFault: return "the session cannot be written; it is tried again every 10 s, and health says why";
    case Event::kSessionGoesOn: return "the session is written again, with all that it lacked of the map";
    case Event::kPoseReset: return "the pose was corrected by more than its uncertainty (reset counter " + number + ")";
  }
  return "?";
}

}  // namespace slamd::pipeline
