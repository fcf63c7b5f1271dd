#include "tools/simulate/simulate.hpp"

#include <cmath>

#include "drivers/recording/pcap_writer.hpp"
#include "drivers/storage/ply_writer.hpp"
#include "tools/simulate/can_log.hpp"
#include "tools/simulate/fault_injector.hpp"
#include "tools/simulate/localisability.hpp"
#include "tools/simulate/packet_stream.hpp"
#include "tools/simulate/text_file.hpp"
#include "tools/simulate/truth.hpp"

namespace slamd::simulate {

namespace fs = std::filesystem;

namespace {

constexpr double kMapSpacing_m = 0.1;

long long stamp_ns(double t_s) { return static_cast<long long>(stamp_at(t_s).time_since_epoch().count()); }

void write_text(const std::string& text, const fs::path& file) {
  TextFile out(file);
  std::fputs(text.c_str(), out.stream());
  out.close();
}

void write_imu(const Scene& scene, FaultInjector* injector, const fs::path& file) {
  ImuFile out(file);
  InertialSensor sensor = scene.imu();
  double t_s = 0.0;
  for (InertialReading reading; sensor.next(t_s, reading);) {
    sensor::ImuSample sample = written_sample(t_s, reading);
    if (injector == nullptr || injector->pass(sample)) {
      out.write(sample, reading.temp_c);
    }
  }
  out.close();
}

void write_wheels(const Scene& scene, const fs::path& file) {
  TextFile out(file);
  std::fprintf(out.stream(), "timestamp_ns,left_m_s,right_m_s,left_ticks,right_ticks,v_m_s,w_rad_s\n");
  WheelSensor sensor(scene.motion(), kWheel_hz, scene.drive().wheel_errors, scene.drive().seed);
  double t_s = 0.0;
  for (WheelReading r; sensor.next(t_s, r);) {
    std::fprintf(out.stream(), "%lld,%.5f,%.5f,%lld,%lld,%.5f,%.6f\n", stamp_ns(t_s), r.left_mps, r.right_mps,
                 static_cast<long long>(r.left_ticks), static_cast<long long>(r.right_ticks), r.v_mps, r.w_radps);
  }
  out.close();
}

void write_gnss(const Scene& scene, const fs::path& file) {
  TextFile out(file);
  std::fprintf(out.stream(), "timestamp_ns,quality,lat_deg,lon_deg,alt_m,sats,hdop,speed_m_s,course_deg\n");
  GnssSensor sensor(scene.motion(), scene.mounting().T_base_antenna, kGnss_hz, scene.drive().gnss_errors,
                    scene.drive().seed);
  double t_s = 0.0;
  for (GnssReading r; sensor.next(t_s, r);) {
    std::fprintf(out.stream(), "%lld,%d,%.9f,%.9f,%.3f,%d,%.1f,%.3f,%.2f\n", stamp_ns(t_s), r.quality,
                 r.place.latitude_deg, r.place.longitude_deg, r.place.altitude_m, r.satellites, r.hdop, r.speed_mps,
                 r.course_deg);
  }
  out.close();
}

void write_map(const Scene& scene, const fs::path& file) {
  storage::PlyWriter map(file);
  for (const Eigen::Vector3f& p : true_map(scene, kMapSpacing_m)) {
    map.write(p);
  }
  map.close();
}

std::uint64_t write_packets(const Scene& scene, FaultInjector* injector, const fs::path& file,
                            const std::function<void(double)>& progress) {
  recording::PcapWriter writer(file);
  PacketStream stream(scene);
  std::uint64_t count = 0;
  const auto write = [&](const recording::Packet& packet) {
    writer.write(packet, kHostAddress);
    ++count;
  };
  std::uint64_t sent_count = 0;
  for (const SentPacket* sent = nullptr; stream.next(sent); ++sent_count) {
    if (injector != nullptr) {
      injector->add(packet_of(*sent), write);
    } else {
      write(packet_of(*sent));
    }
    if (progress && sent_count % 100 == 0) {
      progress(stream.progress());
    }
  }
  if (injector != nullptr) {
    injector->finish(write);
  }
  writer.close();
  return count;
}

}  // namespace

ImuFile::ImuFile(const fs::path& file) : out_(file) {
  std::fprintf(out_.stream(), "timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2,temp_c\n");
}

void ImuFile::write(const sensor::ImuSample& sample, double temp_c) {
  std::fprintf(out_.stream(), "%lld", static_cast<long long>(sample.stamp.time_since_epoch().count()));
  const auto write = [&](const Eigen::Vector3d& v, const char* format) {
    for (int axis = 0; axis < 3; ++axis) {
      char text[48];
      std::snprintf(text, sizeof text, format, v[axis]);
      std::fprintf(out_.stream(), ",%s", text);
    }
  };
  write(sample.angular_rate_radps, kRateFormat);
  write(sample.specific_force_mps2, kForceFormat);
  std::fprintf(out_.stream(), ",%.2f\n", temp_c);
}

void write_parameters(const Drive& drive, const fs::path& directory) {
  write_text(recording_toml(drive), directory / "recording.toml");
  write_text(parameters_json(drive), directory / "simulation.json");
}

void write_surroundings(const Scene& scene, const fs::path& directory) {
  write_truth(scene.motion(), directory / "truth.tum");
  write_loops(true_loops(scene.motion()), directory / "loops.csv");
  write_wheels(scene, directory / "odom.csv");
  write_gnss(scene, directory / "gnss.csv");
  if (scene.drive().can) {
    write_can_log(scene, directory / "can.log");
  }
  if (scene.drive().map) {
    write_map(scene, directory / "true_map.ply");
  }
  if (scene.drive().localisability) {
    write_localisability(scene, directory / "localisability.csv");
  }
}

Summary simulate(const Drive& drive, const fs::path& directory, const std::function<void(double)>& progress) {
  const Scene scene(drive);
  std::optional<FaultInjector> injector;
  if (drive.faults) {
    injector.emplace(*drive.faults, std::ceil(scene.motion().duration_s()));
  }
  FaultInjector* const faulty = injector ? &*injector : nullptr;
  write_parameters(drive, directory);
  write_surroundings(scene, directory);
  write_imu(scene, faulty, directory / "imu.csv");
  Summary summary;
  summary.path_m = scene.path_m();
  summary.packets = write_packets(scene, faulty, directory / "lidar.pcap", progress);
  summary.rays = scene.packets() * scene.lidar().shots();
  if (injector) {
    write_faults(*drive.faults, injector->counts(), directory / "faults.json");
  }
  return summary;
}

}  // namespace slamd::simulate
