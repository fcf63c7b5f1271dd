#include "tools/simulate/simulate.hpp"

#include "drivers/recording/pcap_writer.hpp"
#include "drivers/storage/ply_writer.hpp"
#include "tools/simulate/localisability.hpp"
#include "tools/simulate/packet_stream.hpp"
#include "tools/simulate/text_file.hpp"
#include "tools/simulate/truth.hpp"

namespace slamd::simulate {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kHostAddress = 0xC0A80132;  // 192.168.1.50
constexpr double kGnss_hz = 5.0;
constexpr double kMapSpacing_m = 0.1;

long long stamp_ns(double t_s) { return static_cast<long long>(stamp_at(t_s).time_since_epoch().count()); }

void write_text(const std::string& text, const fs::path& file) {
  TextFile out(file);
  std::fputs(text.c_str(), out.stream());
  out.close();
}

void write_imu(const Scene& scene, const fs::path& file) {
  TextFile out(file);
  std::fprintf(out.stream(), "timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2,temp_c\n");
  InertialSensor sensor = scene.imu();
  double t_s = 0.0;
  for (InertialReading reading; sensor.next(t_s, reading);) {
    std::fprintf(out.stream(), "%lld", stamp_ns(t_s));
    const auto write = [&](const Eigen::Vector3d& v, const char* format) {
      for (int axis = 0; axis < 3; ++axis) {
        char text[48];
        std::snprintf(text, sizeof text, format, v[axis]);
        std::fprintf(out.stream(), ",%s", text);
      }
    };
    write(reading.rate_radps, kRateFormat);
    write(reading.force_mps2, kForceFormat);
    std::fprintf(out.stream(), ",%.2f\n", reading.temp_c);
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

std::uint64_t write_packets(const Scene& scene, const fs::path& file, const std::function<void(double)>& progress) {
  recording::PcapWriter writer(file);
  PacketStream stream(scene);
  std::uint64_t count = 0;
  for (const SentPacket* sent = nullptr; stream.next(sent); ++count) {
    recording::Packet packet;
    packet.received = stamp_at(sent->sent_s);
    packet.source_address = sent->source_address;
    packet.source_port = sent->source_port;
    packet.destination_port = sent->destination_port;
    packet.payload = sent->payload;
    writer.write(packet, kHostAddress);
    if (progress && count % 100 == 0) {
      progress(stream.progress());
    }
  }
  writer.close();
  return count;
}

}  // namespace

Summary simulate(const Drive& drive, const fs::path& directory, const std::function<void(double)>& progress) {
  const Scene scene(drive);
  write_truth(scene.motion(), directory / "truth.tum");
  write_loops(true_loops(scene.motion()), directory / "loops.csv");
  write_imu(scene, directory / "imu.csv");
  write_wheels(scene, directory / "odom.csv");
  write_gnss(scene, directory / "gnss.csv");
  write_text(recording_toml(drive), directory / "recording.toml");
  write_text(parameters_json(drive), directory / "simulation.json");
  if (drive.map) {
    write_map(scene, directory / "true_map.ply");
  }
  if (drive.localisability) {
    write_localisability(scene, directory / "localisability.csv");
  }
  Summary summary;
  summary.path_m = scene.path_m();
  summary.packets = write_packets(scene, directory / "lidar.pcap", progress);
  summary.rays = scene.packets() * scene.lidar().shots();
  return summary;
}

}  // namespace slamd::simulate
