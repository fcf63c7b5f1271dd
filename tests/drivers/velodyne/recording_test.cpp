// Recordings of real sensors; third-party bytes, read where they lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "drivers/clouds/point_folder.hpp"
#include "drivers/gnss/nmea.hpp"
#include "drivers/recording/pcap_reader.hpp"
#include "drivers/velodyne/position.hpp"
#include "made_packet.hpp"

namespace slamd::velodyne {
namespace {

using namespace std::chrono_literals;

namespace fs = std::filesystem;

fs::path recorded(const char* name) { return fs::path(SLAMD_SHARED_DATA_DIR) / "velodyne_packets" / name; }

#define SKIP_UNLESS_THERE(path)                \
  if (!fs::exists(path)) {                     \
    GTEST_SKIP() << (path) << " is not there"; \
  }

/// What became of every packet of a file.
struct Account {
  std::uint64_t packets = 0;
  std::uint64_t decoded = 0;
  std::uint64_t refused = 0;
  std::uint64_t positions = 0;
  std::uint64_t refused_positions = 0;
  std::uint64_t foreign = 0;
  std::uint64_t firings = 0;
  std::uint64_t wraps = 0;      // of the azimuth
  std::uint64_t irregular = 0;  // blocks that do not begin where the last one ended, to 1 µs
  bool whole = false;           // every frame was a datagram and the file ended with a record
  std::vector<Position> all_positions;
};

Account account_of(const fs::path& file, Decoder& sut) {
  recording::PcapReader reader(file);
  recording::Packet packet;
  sensor::PointBlock block;
  Account account;
  DeviceStamp next{};
  int azimuth_cdeg = 0;
  while (reader.next(packet)) {
    ++account.packets;
    if (packet.destination_port == 8308) {
      Position position;
      const bool good = decode_position(packet.payload, position) == PositionResult::kOk;
      ++(good ? account.positions : account.refused_positions);
      account.all_positions.push_back(position);
    } else if (packet.destination_port != 2368) {
      ++account.foreign;
    } else if (sut.decode(packet.payload, packet.received, block) != DecodeResult::kOk) {
      ++account.refused;
    } else {
      ++account.decoded;
      account.firings += block.points.size() + block.empty_firings;
      account.irregular += next != DeviceStamp{} && std::chrono::abs(block.device_stamp - next) > 1us ? 1 : 0;
      next = block.device_stamp + block.duration;
      for (const sensor::Sequence& sequence : block.sequences) {
        account.wraps += sequence.azimuth_cdeg + 18000 < azimuth_cdeg ? 1 : 0;
        azimuth_cdeg = sequence.azimuth_cdeg;
      }
    }
  }
  const auto& frames = reader.counters().frames;
  account.whole = std::accumulate(frames.begin(), frames.end(), std::uint64_t{0}) == account.packets &&
                  !reader.counters().ended_in_a_record;
  return account;
}

TEST(VelodyneRecording, LeavesNoPacketOfTheVlp16Unexplained) {
  SKIP_UNLESS_THERE(recorded("einride/recording.pcap"));
  Decoder sut{DecoderConfig{}};

  const Account account = account_of(recorded("einride/recording.pcap"), sut);

  EXPECT_TRUE(account.whole);
  EXPECT_EQ(account.packets, 1000U);
  EXPECT_EQ(account.decoded, 1000U);
  EXPECT_EQ(account.firings, 384'000U);
  EXPECT_EQ(account.wraps, 13U);
  EXPECT_EQ(account.irregular, 0U);
  EXPECT_EQ(sut.report().last_return_mode, kStrongest);
  EXPECT_EQ(sut.report().last_product, 0x22);
  EXPECT_EQ(sut.report().other_product, 0U);
}

TEST(VelodyneRecording, DecodesTheSameFromTheBarePayloads) {
  SKIP_UNLESS_THERE(recorded("einride/recording.bin"));
  std::ifstream stream(recorded("einride/recording.bin"), std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(stream), {});
  const auto payloads = std::as_bytes(std::span(bytes));
  recording::PcapReader reader(recorded("einride/recording.pcap"));
  recording::Packet packet;
  ASSERT_EQ(payloads.size(), 1000 * Decoder::kPacketBytes);

  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(reader.next(packet));
    const auto payload = payloads.subspan(i * Decoder::kPacketBytes, Decoder::kPacketBytes);
    ASSERT_TRUE(std::equal(payload.begin(), payload.end(), packet.payload.begin(), packet.payload.end())) << i;
  }
  EXPECT_FALSE(reader.next(packet));
}

TEST(VelodyneRecording, LeavesNoPacketOfTheHdl32eUnexplained) {
  SKIP_UNLESS_THERE(recorded("mrpt/sample_velodyne_hdl32.pcap"));
  Decoder sut{DecoderConfig{}};

  const Account account = account_of(recorded("mrpt/sample_velodyne_hdl32.pcap"), sut);

  EXPECT_TRUE(account.whole);
  EXPECT_EQ(account.packets, 500U);
  EXPECT_EQ(account.decoded, 500U);
  EXPECT_EQ(account.firings, 192'000U);
  EXPECT_EQ(account.wraps, 3U);
  EXPECT_EQ(account.irregular, 0U);
  EXPECT_EQ(sut.report().last_product, 0x21);
}

TEST(VelodyneRecording, NamesTheOddProductByteOfAnEarlyVlp16) {
  SKIP_UNLESS_THERE(recorded("rust_lidar_utils/velodyne_vlp16.pcap"));
  Decoder sut({.model = Model::kVlp16, .vertical_parallax = false});

  const Account account = account_of(recorded("rust_lidar_utils/velodyne_vlp16.pcap"), sut);

  EXPECT_TRUE(account.whole);
  EXPECT_EQ(account.decoded, 84U);
  EXPECT_EQ(account.positions, 16U);
  EXPECT_EQ(account.irregular, 0U);
  EXPECT_EQ(sut.report().other_product, 84U);
  EXPECT_EQ(sut.report().last_product, 0x21);
  for (const Position& position : account.all_positions) {
    EXPECT_EQ(position.pps, PpsState::kNone);
    EXPECT_EQ(position.text(), "");
  }
}

TEST(VelodyneRecording, ReadsTheSentencesBetweenThePacketsOfAnHdl32e) {
  SKIP_UNLESS_THERE(recorded("rust_lidar_utils/velodyne_vlp32.pcap"));
  Decoder sut{DecoderConfig{}};

  const Account account = account_of(recorded("rust_lidar_utils/velodyne_vlp32.pcap"), sut);

  EXPECT_TRUE(account.whole);
  EXPECT_EQ(account.decoded, 91U);
  EXPECT_EQ(account.positions, 9U);
  EXPECT_EQ(account.irregular, 0U);
  EXPECT_EQ(sut.report().last_product, 0x21);
  for (const Position& position : account.all_positions) {
    const auto rmc = gnss::parse_rmc(position.text());
    ASSERT_TRUE(rmc && rmc->utc && rmc->place);
    EXPECT_TRUE(rmc->valid);
    EXPECT_EQ(rmc->utc->time_since_epoch(), 1'355'262'376s);  // 2012-12-11 21:46:16 UTC
    EXPECT_NEAR(rmc->place->latitude_deg, 37.139, 1e-3);
    EXPECT_NEAR(rmc->place->longitude_deg, -121.657, 1e-3);
    // The stamp counts from the same hour: 46 min and some seconds.
    EXPECT_EQ(std::chrono::floor<std::chrono::minutes>(position.device_stamp.time_since_epoch()), 46min);
  }
}

TEST(VelodyneRecording, LeavesNoPacketOfTheVlp32cUnexplained) {
  SKIP_UNLESS_THERE(recorded("nebula_vlp32/packets.pcap"));
  Decoder sut{DecoderConfig{}};

  const Account account = account_of(recorded("nebula_vlp32/packets.pcap"), sut);

  EXPECT_TRUE(account.whole);
  EXPECT_EQ(account.packets, 379U);
  EXPECT_EQ(account.decoded, 379U);
  EXPECT_EQ(account.firings, 379U * 384U);
  EXPECT_EQ(account.irregular, 0U);  // though five packets reach across the half turn that is left out
  EXPECT_EQ(account.wraps, 5U);
  EXPECT_EQ(sut.report().last_product, 0x28);
}

/// A decoded point, with the head's azimuth at the first firing of its sequence and how fast it turns there.
struct Fired {
  sensor::Point point;
  double azimuth_deg = 0.0;
  double turning_degps = 0.0;
  double since_azimuth_s = 0.0;
  bool in_last_block = false;  // of its packet
};

std::vector<Fired> fired_in(const fs::path& file) {
  recording::PcapReader reader(file);
  recording::Packet packet;
  Decoder decoder{DecoderConfig{}};
  sensor::PointBlock block;
  std::vector<Fired> all;
  while (reader.next(packet) && decoder.decode(packet.payload, packet.received, block) == DecodeResult::kOk) {
    const std::size_t sequences = block.sequences.size();
    double gap_deg = 0.2;
    for (std::size_t s = 0; s < sequences; ++s) {
      const double azimuth_deg = 0.01 * block.sequences[s].azimuth_cdeg;
      const double step_deg = s + 1 < sequences ? 0.01 * block.sequences[s + 1].azimuth_cdeg - azimuth_deg : gap_deg;
      gap_deg = step_deg > 0.0 && step_deg < 1.5 ? step_deg : gap_deg;
      const std::size_t end = s + 1 < sequences ? block.sequences[s + 1].first_point : block.points.size();
      for (std::size_t i = block.sequences[s].first_point; i < end; ++i) {
        const double firing_us = std::fmod(1e-3 * block.points[i].offset_ns + 0.01, 55.296);
        all.push_back({block.points[i], azimuth_deg, gap_deg / 55.296e-6, 1e-6 * firing_us,
                       s + 1 == sequences});
      }
    }
  }
  return all;
}

/// The rings of a cloud, by nothing but its own elevations: lasers differ by 0.3° at the least.
std::vector<int> rings_of(const std::vector<Direction>& cloud) {
  std::vector<double> elevations_deg;
  for (const Direction& direction : cloud) {
    elevations_deg.push_back(direction.elevation_deg);
  }
  std::sort(elevations_deg.begin(), elevations_deg.end());
  std::vector<double> firsts_deg;
  for (const double elevation_deg : elevations_deg) {
    if (firsts_deg.empty() || elevation_deg > firsts_deg.back() + 0.15) {
      firsts_deg.push_back(elevation_deg);
    }
  }
  std::vector<int> rings;
  for (const Direction& direction : cloud) {
    const auto above = std::upper_bound(firsts_deg.begin(), firsts_deg.end(), direction.elevation_deg);
    rings.push_back(static_cast<int>(above - firsts_deg.begin()) - 1);
  }
  return rings;
}

/// Turns a point further in the head's sense: clockwise seen from above.
sensor::Point turned(const sensor::Point& point, double angle_deg) {
  const double c = std::cos(angle_deg * M_PI / 180.0);
  const double s = std::sin(angle_deg * M_PI / 180.0);
  sensor::Point result = point;
  result.x_m = static_cast<float>(c * point.x_m + s * point.y_m);
  result.y_m = static_cast<float>(c * point.y_m - s * point.x_m);
  return result;
}

double distance_m(const sensor::Point& a, const sensor::Point& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

/// When the other decoder lets a laser of a VLP-32C fire, after its block's azimuth was read: one by one, 2.304 µs
/// apart, which makes 73.7 µs of a sequence that takes 55.3 (they fire in pairs); and all at once in the last block
/// of a packet, for want of a next azimuth.
double time_of_the_other_s(std::size_t laser, bool in_last_block) {
  return in_last_block ? 0.0 : 2.304e-6 * static_cast<double>(laser);
}

// The other decoder's first scan of the same packets. It holds x, y, z only, in firing order: its rings follow from
// its elevations, and its times from how far the head has turned when a laser fires. Its times being what they are,
// this decoder's points are turned by the difference of the two times, and by nothing else, before they are compared.
TEST(VelodyneRecording, AgreesWithTheOtherDecodersCloudOfAVlp32c) {
  const fs::path cloud_file = recorded("nebula_vlp32/1713492677464078412.pcd");
  SKIP_UNLESS_THERE(cloud_file);
  std::vector<std::byte> bytes;
  clouds::RawCloud cloud;
  ASSERT_FALSE(clouds::read_cloud_file(cloud_file, bytes, cloud));
  std::vector<sensor::Point> expected(cloud.points);
  std::vector<Direction> directions;
  for (std::size_t i = 0; i < cloud.points; ++i) {
    expected[i].x_m = static_cast<float>(cloud.number(*cloud.find("x"), i));
    expected[i].y_m = static_cast<float>(cloud.number(*cloud.find("y"), i));
    expected[i].z_m = static_cast<float>(cloud.number(*cloud.find("z"), i));
    directions.push_back(direction_of(expected[i]));
  }
  const std::vector<int> rings = rings_of(directions);
  const ModelTable& table = table_of(Model::kVlp32c);
  std::vector<std::size_t> laser_of_ring(32);
  for (std::size_t laser = 0; laser < 32; ++laser) {
    laser_of_ring[table.ring[laser]] = laser;
  }

  const std::vector<Fired> fired = fired_in(recorded("nebula_vlp32/packets.pcap"));

  std::size_t near_as_it_is = 0;
  std::size_t near = 0;
  std::size_t near_with_ring = 0;
  std::size_t near_with_ring_and_time = 0;
  double farthest_us = 0.0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // Both clouds are in firing order; the other one leaves out what is beyond its field of view. A range is a
    // whole number of 4 mm, so the next of the same range is the same return.
    std::size_t at = next;
    while (at < fired.size() && std::abs(direction_of(fired[at].point).range_m - directions[i].range_m) > 0.001) {
      ++at;
    }
    if (at == fired.size()) {
      continue;
    }
    next = at + 1;
    const std::size_t laser = laser_of_ring[fired[at].point.line];
    const double time_s = time_of_the_other_s(laser, fired[at].in_last_block);
    const double later_s = time_s - fired[at].since_azimuth_s;
    const sensor::Point point = turned(fired[at].point, fired[at].turning_degps * later_s);
    near_as_it_is += distance_m(fired[at].point, expected[i]) <= 0.010 ? 1 : 0;
    if (distance_m(point, expected[i]) > 0.010) {
      continue;
    }
    ++near;
    if (point.line != rings[i]) {
      continue;
    }
    ++near_with_ring;
    const double turned_deg = std::remainder(
        directions[i].azimuth_deg + table.azimuth_offset_deg[laser] - fired[at].azimuth_deg, 360.0);
    const double apart_us = 1e6 * std::abs(turned_deg / fired[at].turning_degps - time_s);
    farthest_us = std::max(farthest_us, apart_us);
    near_with_ring_and_time += apart_us < 5.0 ? 1 : 0;
  }

  const auto percent = [&](std::size_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(expected.size());
  };
  std::printf("%zu points: %.3f %% within 10 mm, with their rings %.3f %%, with their times %.3f %% (worst %.1f us); "
              "without regard to the times %.3f %%\n",
              expected.size(), percent(near), percent(near_with_ring), percent(near_with_ring_and_time), farthest_us,
              percent(near_as_it_is));
  EXPECT_EQ(expected.size(), 26'216U);
  EXPECT_EQ(*std::max_element(rings.begin(), rings.end()), 31);
  EXPECT_GE(percent(near_with_ring_and_time), 99.0);
  EXPECT_GE(percent(near_as_it_is), 80.0);
}

}  // namespace
}  // namespace slamd::velodyne
