#include "tools/simulate/simulate.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "drivers/recording/pcap_writer.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/simulate/inertial_sensor.hpp"
#include "tools/simulate/livox_lidar.hpp"
#include "tools/simulate/spinning_lidar.hpp"
#include "tools/simulate/town.hpp"

namespace slamd::simulate {

namespace fs = std::filesystem;

namespace {

constexpr std::int64_t kStart_unix_s = 1'790'000'000;  // 2026-09-21 14:13:20 UTC
constexpr double kHourOffset_s = 13.0 * 60.0 + 20.0;
constexpr double kBaseHeight_m = 0.45;
constexpr double kTruthRate_hz = 100.0;
constexpr std::size_t kBatch = 512;  // packets made side by side

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Stream open(const fs::path& file) {
  Stream stream(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!stream) {
    throw recording::RecordingError(file, std::strerror(errno));
  }
  return stream;
}

void close(Stream& stream, const fs::path& file) {
  const bool failed = std::ferror(stream.get()) != 0;
  if (std::fclose(stream.release()) != 0 || failed) {
    throw recording::RecordingError(file, "could not be written whole");
  }
}

Stamp stamp_at(double t_s) { return Stamp{} + std::chrono::seconds(kStart_unix_s) + from_seconds(t_s); }

/// Where the sensors sit on the vehicle.
struct Mounting {
  geometry::Se3 T_base_lidar;
  geometry::Se3 T_base_imu;
};

Mounting mounting_of(LidarKind lidar) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  if (lidar == LidarKind::kVlp16) {
    return {{I, {0.12, 0.0, 0.26}}, {I, {0.0, 0.0, 0.0}}};
  }
  return {{I, {0.04165, 0.02326, -0.0284}}, {I, {-0.06, 0.03, -0.08}}};
}

void write_truth(const Motion& motion, const fs::path& file) {
  Stream stream = open(file);
  for (int i = 0; i <= static_cast<int>(motion.duration_s() * kTruthRate_hz); ++i) {
    const double t_s = i / kTruthRate_hz;
    recording::write_tum_line(stream.get(), stamp_at(t_s), motion.pose_at(t_s));
  }
  close(stream, file);
}

void write_imu(const std::vector<InertialReading>& readings, double rate_hz, const fs::path& file) {
  Stream stream = open(file);
  std::fprintf(stream.get(), "timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n");
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const Eigen::Vector3d& w = readings[i].rate_radps;
    const Eigen::Vector3d& f = readings[i].force_mps2;
    std::fprintf(stream.get(), "%lld,%.7f,%.7f,%.7f,%.6f,%.6f,%.6f\n",
                 static_cast<long long>(stamp_at(static_cast<double>(i) / rate_hz).time_since_epoch().count()), w.x(),
                 w.y(), w.z(), f.x(), f.y(), f.z());
  }
  close(stream, file);
}

void write_toml(const Drive& drive, const Mounting& mounting, const fs::path& file) {
  Stream stream = open(file);
  const Eigen::Vector3d& l = mounting.T_base_lidar.translation();
  const Eigen::Vector3d& i = mounting.T_base_imu.translation();
  std::fprintf(stream.get(),
               "# Simulated: town, seed %llu, %.0f s. See simulation.json.\n[[lidar]]\nmodel = \"%s\"\nsource = \"lidar.pcap\"\n"
               "T_base_lidar = { xyz_m = [%.5f, %.5f, %.5f], rpy_deg = [0.0, 0.0, 0.0] }\n\n[imu]\nsource = \"imu.csv\"\n"
               "T_base_imu = { xyz_m = [%.5f, %.5f, %.5f], rpy_deg = [0.0, 0.0, 0.0] }\n",
               static_cast<unsigned long long>(drive.seed), drive.duration_s,
               drive.lidar == LidarKind::kVlp16 ? "vlp16" : "livox_avia", l.x(), l.y(), l.z(), i.x(), i.y(), i.z());
  close(stream, file);
}

void write_parameters(const Drive& drive, const RangeErrors& range, const InertialErrors& imu, const fs::path& file) {
  Stream stream = open(file);
  std::fprintf(stream.get(),
               "{\n  \"world\": \"town\",\n  \"lidar\": \"%s\",\n  \"seed\": %llu,\n  \"duration_s\": %g,\n  \"speed_mps\": %g,\n"
               "  \"rest_s\": %g,\n  \"base_height_m\": %g,\n  \"range_noise_m\": %g,\n  \"beam_bias_m\": %g,\n"
               "  \"max_range_m\": %g,\n  \"imu_rate_hz\": %g,\n  \"gyro_noise_radps_sqrthz\": %g,\n"
               "  \"accel_noise_mps2_sqrthz\": %g,\n  \"gyro_bias_radps\": %g,\n  \"accel_bias_mps2\": %g,\n"
               "  \"gyro_walk_radps2_sqrthz\": %g,\n  \"accel_walk_mps3_sqrthz\": %g,\n  \"imu_scale\": %g,\n"
               "  \"imu_misalignment_rad\": %g\n}\n",
               drive.lidar == LidarKind::kVlp16 ? "vlp16" : "livox_avia", static_cast<unsigned long long>(drive.seed),
               drive.duration_s, drive.speed_mps, drive.rest_s, kBaseHeight_m, range.noise_m, range.beam_bias_m,
               range.max_range_m, drive.imu_rate_hz, imu.gyro_noise_radps_sqrthz, imu.accel_noise_mps2_sqrthz,
               imu.gyro_bias_radps, imu.accel_bias_mps2, imu.gyro_walk_radps2_sqrthz, imu.accel_walk_mps3_sqrthz,
               imu.scale, imu.misalignment_rad);
  close(stream, file);
}

double path_of(const Motion& motion) {
  double length = 0.0;
  Eigen::Vector3d last = motion.pose_at(0.0).translation();
  for (double t = 0.1; t <= motion.duration_s(); t += 0.1) {
    const Eigen::Vector3d now = motion.pose_at(t).translation();
    length += (now - last).norm();
    last = now;
  }
  return length;
}

/// Makes packets [0, count) with `make` on several threads and writes them, with those of `extra`, in sending order.
template <typename Make>
void write_packets(std::uint64_t count, int threads, Make&& make, std::vector<SentPacket> extra, const fs::path& file,
                   std::uint32_t address, const std::function<void(double)>& progress) {
  recording::PcapWriter writer(file);
  std::size_t next_extra = 0;
  const auto write = [&](const SentPacket& sent) {
    recording::Packet packet;
    packet.received = stamp_at(sent.sent_s);
    packet.source_address = address;
    packet.source_port = sent.destination_port == LivoxLidar::kPort ? 65000 : sent.destination_port;
    packet.destination_port = sent.destination_port;
    packet.payload = sent.payload;
    writer.write(packet, 0xC0A80132);  // 192.168.1.50
  };
  std::vector<SentPacket> batch(kBatch);
  for (std::uint64_t begin = 0; begin < count; begin += kBatch) {
    const std::size_t size = std::min<std::uint64_t>(kBatch, count - begin);
    std::vector<std::thread> workers;
    for (int worker = 0; worker < threads; ++worker) {
      workers.emplace_back([&, worker] {
        for (auto i = static_cast<std::size_t>(worker); i < size; i += static_cast<std::size_t>(threads)) {
          batch[i] = make(begin + i);
        }
      });
    }
    for (std::thread& worker : workers) {
      worker.join();
    }
    std::sort(batch.begin(), batch.begin() + static_cast<std::ptrdiff_t>(size),
              [](const SentPacket& a, const SentPacket& b) { return a.sent_s < b.sent_s; });
    for (std::size_t i = 0; i < size; ++i) {
      for (; next_extra < extra.size() && extra[next_extra].sent_s <= batch[i].sent_s; ++next_extra) {
        write(extra[next_extra]);
      }
      write(batch[i]);
    }
    if (progress) {
      progress(static_cast<double>(begin + size) / static_cast<double>(count));
    }
  }
  writer.close();
}

}  // namespace

Summary simulate(const Drive& drive, const fs::path& directory, const std::function<void(double)>& progress) {
  const Town town(drive.seed);
  const Mounting mounting = mounting_of(drive.lidar);
  const Motion motion = town.tour(drive.duration_s, drive.speed_mps, drive.rest_s, kBaseHeight_m);
  const InertialErrors imu_errors;
  RangeErrors range_errors;
  write_truth(motion, directory / "truth.tum");
  write_imu(readings(motion, mounting.T_base_imu, drive.imu_rate_hz, imu_errors, drive.seed), drive.imu_rate_hz,
            directory / "imu.csv");
  write_toml(drive, mounting, directory / "recording.toml");
  Summary summary;
  summary.path_m = path_of(motion);
  std::vector<SentPacket> extra;
  if (drive.lidar == LidarKind::kVlp16) {
    const SpinningLidar lidar(town.world(), motion, mounting.T_base_lidar, range_errors, drive.seed);
    const auto count = static_cast<std::uint64_t>(motion.duration_s() / SpinningLidar::kPacket_s);
    for (std::uint64_t i = 14; i < count; i += 14) {
      extra.push_back(lidar.position_packet(static_cast<double>(i) * SpinningLidar::kPacket_s, kHourOffset_s, kStart_unix_s));
    }
    summary.rays = count * 384;
    summary.packets = count + extra.size();
    write_packets(count, drive.threads, [&](std::uint64_t i) { return lidar.data_packet(i, kHourOffset_s); }, std::move(extra),
                  directory / "lidar.pcap", 0xC0A801C9, progress);
  } else {
    range_errors = {0.015, 0.004, 190.0, 1.0};
    const LivoxLidar lidar(town.world(), motion, mounting.T_base_lidar, range_errors, drive.seed);
    // The built-in sensor: its axes are the lidar's, its place is the Avia's.
    const geometry::Se3 T_base_own = mounting.T_base_lidar * geometry::Se3(Eigen::Matrix3d::Identity(), {-0.04165, -0.02326, 0.0284});
    const std::vector<InertialReading> own = readings(motion, T_base_own, 200.0, imu_errors, drive.seed + 1'000'003);
    for (std::size_t i = 0; i < own.size(); ++i) {
      extra.push_back(lidar.imu_packet(static_cast<double>(i) / 200.0, own[i]));
    }
    const auto count = static_cast<std::uint64_t>(motion.duration_s() / LivoxLidar::kPacket_s);
    summary.rays = count * 96;
    summary.packets = count + extra.size();
    write_packets(count, drive.threads, [&](std::uint64_t i) { return lidar.point_packet(i); }, std::move(extra),
                  directory / "lidar.pcap", 0xC0A80164, progress);
  }
  write_parameters(drive, range_errors, imu_errors, directory / "simulation.json");
  return summary;
}

}  // namespace slamd::simulate
