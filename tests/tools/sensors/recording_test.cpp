// What real devices have sent; third-party bytes, read where they lie.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "drivers/recording/pcap_reader.hpp"
#include "made_bytes.hpp"
#include "tools/sensors/network_watch.hpp"
#include "tools/sensors/serial_watch.hpp"

namespace slamd::sensors {
namespace {

using configuration::LidarModel;

namespace fs = std::filesystem;

fs::path recorded(const std::string& name) { return fs::path(SLAMD_SHARED_DATA_DIR) / name; }

#define SKIP_UNLESS_THERE(path)                                              \
  if (!fs::exists(path)) {                                                   \
    GTEST_SKIP() << (path) << " is not there: real recordings are not read"; \
  }

/// What is found of a stream that one begins to hear in the middle, in pieces of 100 bytes.
LineSeen found_in(const fs::path& file, std::size_t begin) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  const Bytes bytes = text_bytes(std::string_view(text).substr(begin));
  SerialWatch sut(kBegin);
  for (std::size_t at = 0; at < bytes.size(); at += 100) {
    sut.take(std::span(bytes).subspan(at, std::min<std::size_t>(100, bytes.size() - at)), kBegin);
  }
  return sut.seen();
}

TEST(RealStream, OfEachXsensIsFound) {
  SKIP_UNLESS_THERE(recorded("imu_gnss/xsens_go"));
  for (const char* name : {"1", "2", "3", "4", "5"}) {
    const LineSeen seen = found_in(recorded(std::string("imu_gnss/xsens_go/") + name + "/output.bin"), 77);

    EXPECT_EQ(seen.tongue, Tongue::kXsens) << name;
    EXPECT_TRUE(seen.found);
    EXPECT_EQ(seen.imu.samples.total, name[0] == '5' ? 0U : 95U) << name;  // the fifth sends no inertial data
    EXPECT_EQ(seen.imu.missing, 0U) << name;
  }
}

TEST(RealStream, OfAMicroStrainIsFound) {
  SKIP_UNLESS_THERE(recorded("imu_gnss/microstrain_mip/mip_data.bin"));

  EXPECT_EQ(found_in(recorded("imu_gnss/microstrain_mip/mip_data.bin"), 33).tongue, Tongue::kMip);
}

TEST(RealStream, OfEachReceiverIsFoundWithItsFixes) {
  SKIP_UNLESS_THERE(recorded("imu_gnss/gpsd_logs"));
  for (const char* name : {"quectel-l76k-nmea.log", "ublox-zed-f9p_hpg1.11.log", "ublox-zed-f9r.log"}) {
    const LineSeen seen = found_in(recorded(std::string("imu_gnss/gpsd_logs/") + name), 2000);

    EXPECT_EQ(seen.tongue, Tongue::kGnss) << name;
    EXPECT_GT(seen.gnss.fixes.total, 20U) << name;
    EXPECT_GT(seen.gnss.sentences.total + seen.gnss.ubx.total, seen.gnss.fixes.total) << name;
  }
}

/// What is found in a capture.
Seen found_in_capture(const fs::path& file) {
  recording::PcapReader reader(file);
  recording::Packet packet;
  NetworkWatch sut;
  while (reader.next(packet)) {
    sut.take({packet.payload, packet.source_address, packet.destination_port, packet.received}, kInterfaces);
  }
  Seen seen;
  sut.show(kBegin, seen);
  return seen;
}

TEST(RealPackets, OfAVlp16AreAllItsOwn) {
  const fs::path file = recorded("velodyne_packets/einride/recording.pcap");
  SKIP_UNLESS_THERE(file);

  const Seen seen = found_in_capture(file);

  ASSERT_EQ(seen.lidars.size(), 1U);
  EXPECT_EQ(seen.lidars[0].model, LidarModel::kVlp16);
  EXPECT_EQ(seen.lidars[0].packets.total, 1000U);
  EXPECT_EQ(seen.lidars[0].refused, 0U);
}

TEST(RealPackets, OfOtherVelodynesTellTheirModel) {
  for (const auto& [name, model] : {std::pair("nebula_vlp32/packets.pcap", LidarModel::kVlp32c),
                                    std::pair("mrpt/sample_velodyne_hdl32.pcap", LidarModel::kHdl32e)}) {
    const fs::path file = recorded(std::string("velodyne_packets/") + name);
    SKIP_UNLESS_THERE(file);

    const Seen seen = found_in_capture(file);

    ASSERT_FALSE(seen.lidars.empty()) << name;
    EXPECT_EQ(seen.lidars[0].model, model) << name;
    EXPECT_GT(seen.lidars[0].packets.total, 10U) << name;
  }
}

}  // namespace
}  // namespace slamd::sensors
