#include "tools/replay/to_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include <nlohmann/json.hpp>

#include "drivers/imu/csv_rows.hpp"
#include "drivers/imu/line_setup.hpp"
#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/pcap_writer.hpp"
#include "drivers/transport/serial_port.hpp"
#include "drivers/transport/udp_receiver.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::replay {
namespace {

using recording::Packet;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Stamp kBegin = Stamp{} + seconds(1'700'000'000);
constexpr std::uint32_t kLoopback = 0x7F000001;

/// Time that passes only while one sleeps; whoever receives has a look on each occasion.
class VirtualClock : public SendClock {
 public:
  Duration now() override { return now_; }

  void sleep_until(Duration deadline) override {
    if (while_asleep) {
      while_asleep();
    }
    now_ = std::max(now_, deadline + oversleeps);
  }

  std::function<void()> while_asleep;
  Duration oversleeps{};

 private:
  Duration now_ = seconds(1000);
};

/// What has come in at a port of the loopback.
class Listener {
 public:
  Listener() : receiver_({"127.0.0.1", 0, "", 4 << 20}, transport::HostClock()) {}

  std::uint16_t port() const { return receiver_.port(); }

  void drain(Duration now) {
    while (receiver_.receive([&](const transport::Datagram& datagram) {
      payloads.emplace_back(datagram.payload.begin(), datagram.payload.end());
      times.push_back(now);
    }) > 0) {
    }
  }

  std::vector<std::vector<std::byte>> payloads;
  std::vector<Duration> times;

 private:
  transport::UdpReceiver receiver_;
};

class ToNetwork : public scratch::ScratchFolder {
 protected:
  ToNetwork() {
    options_.address = kLoopback;
    options_.data_port = data_.port();
    options_.position_port = position_.port();
    clock_.while_asleep = [this] { drain(); };
  }

  void drain() {
    for (Listener* listener : {&data_, &position_, &imu_}) {
      listener->drain(clock_.now());
    }
  }

  /// Packets 1.25 ms apart, each tenth a position packet, each seventh foreign; all with different bytes.
  Recording made_recording(int packets, Duration step = microseconds(1250)) {
    std::filesystem::create_directories(folder_);
    recording::PcapWriter writer(folder_ / "lidar.pcap");
    for (int i = 0; i < packets; ++i) {
      std::vector<std::byte> payload(i % 10 == 3 ? 512 : 1206);
      std::memcpy(payload.data(), &i, sizeof i);
      Packet packet;
      packet.received = kBegin + i * step;
      packet.destination_port = i % 10 == 3 ? 8308 : i % 7 == 0 ? 5555 : 2368;
      packet.payload = payload;
      writer.write(packet);
      (i % 10 == 3 ? sent_positions_ : i % 7 == 0 ? sent_foreign_ : sent_data_).push_back(payload);
    }
    writer.close();
    write("recording.toml", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\n");
    return open_recording(folder_, {}, {});
  }

  /// Rows 5 ms apart from 10 ms before the first packet on.
  void write_imu(int rows) {
    std::string text = "timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n";
    for (int i = 0; i < rows; ++i) {
      const Stamp stamp = kBegin - milliseconds(10) + i * milliseconds(5);
      text += std::to_string(stamp.time_since_epoch().count()) + ",0.001,-0.25,1e-7," + std::to_string(i) + ",0,9.80665\n";
    }
    write("imu.csv", text);
  }

  ToNetworkReport send(const Recording& recording, const std::function<bool()>& stopped = nullptr) {
    const ToNetworkReport report = send_to_network(recording, options_, clock_, stopped, nullptr);
    drain();
    return report;
  }

  Listener data_;
  Listener position_;
  Listener imu_;
  VirtualClock clock_;
  ToNetworkOptions options_;
  std::vector<std::vector<std::byte>> sent_data_;
  std::vector<std::vector<std::byte>> sent_positions_;
  std::vector<std::vector<std::byte>> sent_foreign_;
};

TEST_F(ToNetwork, SendsEachPacketOfTheLidarInOrderAndCountsTheRest) {
  write_imu(10);

  const ToNetworkReport sut = send(made_recording(1000));

  EXPECT_TRUE(data_.payloads == sent_data_);
  EXPECT_TRUE(position_.payloads == sent_positions_);
  EXPECT_EQ(sut.lidar, sent_data_.size());
  EXPECT_EQ(sut.position, 100U);
  EXPECT_EQ(sut.foreign, sent_foreign_.size());
  EXPECT_EQ(sut.imu_rows, 0U);
  EXPECT_FALSE(sut.interrupted);
}

TEST_F(ToNetwork, SendsEachPacketAtItsTime) {
  write_imu(10);

  const ToNetworkReport sut = send(made_recording(1000));

  // A packet is seen on the next sleep, which is the one until its successor's time.
  const Duration began = data_.times.front();
  std::size_t at = 0;
  for (int i = 0; i < 1000; ++i) {
    if (i % 10 != 3 && i % 7 != 0) {
      EXPECT_EQ(data_.times[at++] - began, microseconds(1250) * (i - 1)) << i;
    }
  }
  EXPECT_EQ(sut.worst_lateness, Duration(0));
  EXPECT_EQ(sut.recording, microseconds(1250) * 999);
  EXPECT_EQ(sut.took, sut.recording);
}

TEST_F(ToNetwork, RunsAtTheSpeedThatIsAskedFor) {
  write_imu(10);
  options_.speed = 4.0;

  const ToNetworkReport sut = send(made_recording(1000));

  EXPECT_EQ(sut.took, sut.recording / 4);
}

TEST_F(ToNetwork, MakesUpForSleepingTooLongAndSaysHowLong) {
  write_imu(10);
  clock_.oversleeps = microseconds(300);

  const ToNetworkReport sut = send(made_recording(1000));

  EXPECT_EQ(sut.worst_lateness, microseconds(300));
  EXPECT_GT(sut.mean_lateness, Duration(0));
  EXPECT_LE(sut.took - sut.recording, microseconds(300));
}

TEST_F(ToNetwork, PausesAfterEachBurstWhenItIsInNoTimeOrLate) {
  write_imu(10);
  for (const double speed : {0.0, 1.0}) {
    data_.payloads.clear();
    sent_data_.clear();
    options_.speed = speed;
    std::size_t seen = data_.payloads.size() + position_.payloads.size();
    std::size_t longest_burst = 0;
    clock_.while_asleep = [&] {
      drain();
      const std::size_t now_seen = data_.payloads.size() + position_.payloads.size();
      longest_burst = std::max(longest_burst, now_seen - seen);
      seen = now_seen;
    };

    send(made_recording(1000, Duration(0)));  // all at once

    EXPECT_EQ(longest_burst, static_cast<std::size_t>(kBurst)) << speed;
    EXPECT_TRUE(data_.payloads == sent_data_) << speed;
  }
}

TEST_F(ToNetwork, SendsInertialRowsAmongThePacketsThatReadBackToTheSameBits) {
  write_imu(200);
  const Recording recording = made_recording(800);
  options_.imu_address = kLoopback;
  options_.imu_port = imu_.port();

  const ToNetworkReport sut = send(recording);

  EXPECT_EQ(sut.imu_rows, 200U);
  ASSERT_EQ(imu_.payloads.size(), 200U);
  imu::CsvRows rows;
  std::vector<sensor::ImuReading> readings;
  for (const auto& payload : imu_.payloads) {
    rows.add_datagram(payload, Stamp{}, [&](const sensor::ImuReading& reading) { readings.push_back(reading); });
  }
  recording::ImuCsvReader file(recording.imu_csv);
  sensor::ImuSample sample;
  for (std::size_t i = 0; i < 200; ++i) {
    ASSERT_TRUE(file.next(sample));
    EXPECT_EQ(readings[i].device_stamp.time_since_epoch(), sample.stamp.time_since_epoch());
    EXPECT_EQ(readings[i].angular_rate_radps, sample.angular_rate_radps);
    EXPECT_EQ(readings[i].specific_force_mps2, sample.specific_force_mps2);
    EXPECT_NEAR(to_seconds(imu_.times[i] - imu_.times[0]), 0.005 * static_cast<double>(i), 0.006);
  }
}

TEST_F(ToNetwork, LeavesOutRowsFromLongBeforeAndAfterThePackets) {
  write_imu(2000);  // ten seconds; packets for one
  Recording recording = made_recording(800);
  options_.imu_address = kLoopback;
  options_.imu_port = imu_.port();

  const ToNetworkReport sut = send(recording);

  EXPECT_EQ(sut.imu_rows, imu_.payloads.size());
  EXPECT_EQ(sut.imu_rows + sut.imu_outside, 2000U);
  EXPECT_NEAR(static_cast<double>(sut.imu_rows), 600.0, 5.0);
}

TEST_F(ToNetwork, SendsRowsThroughATerminalWithoutLosingOne) {
  write_imu(500);
  const Recording recording = made_recording(2000);
  options_.imu_terminal = folder_ / "imu";
  transport::SerialPort port({folder_ / "imu"});
  imu::CsvRows rows;
  std::uint64_t received = 0;
  clock_.while_asleep = [&] {
    drain();
    if (!port.is_open()) {
      ASSERT_EQ(port.open(), 0);
    }
    for (auto bytes = port.read(); !bytes.empty(); bytes = port.read()) {
      rows.add_stream(bytes, Stamp{}, [&](const sensor::ImuReading&) { ++received; });
    }
  };

  const ToNetworkReport sut = send(recording);

  EXPECT_EQ(sut.imu_rows, 500U);
  EXPECT_EQ(received, 500U);
  EXPECT_EQ(rows.counters().of(imu::RowResult::kFragment), 0U);
  EXPECT_FALSE(std::filesystem::is_symlink(folder_ / "imu"));
  EXPECT_TRUE(data_.payloads == sent_data_);
}

TEST_F(ToNetwork, SendsSamplesAsASensorThatItsHostConfigures) {
  for (const imu::Protocol protocol : {imu::Protocol::kXsens, imu::Protocol::kMip}) {
    write_imu(500);
    const Recording recording = made_recording(2000);
    options_.imu_terminal = folder_ / "imu";
    options_.imu_protocol = protocol;
    transport::SerialPort port({folder_ / "imu"});
    imu::LineSetup host({protocol, 921'600, 100});
    imu::ImuStream stream(protocol);
    std::uint64_t received = 0;
    clock_.while_asleep = [&] {
      drain();
      imu::LineOutput out;
      if (!port.is_open()) {
        ASSERT_EQ(port.open(), 0);
        host.begin(Stamp{} + clock_.now(), out);
      }
      host.advance(Stamp{} + clock_.now(), out);
      for (auto bytes = port.read(); !bytes.empty(); bytes = port.read()) {
        bytes = bytes.subspan(host.receive(bytes, Stamp{} + clock_.now(), out));
        stream.add(bytes, Stamp{}, [&](const sensor::ImuReading&) { ++received; });
      }
      port.write(out.bytes.view());
    };

    const ToNetworkReport sut = send(recording);

    EXPECT_TRUE(host.is_ready());
    EXPECT_EQ(sut.imu_rows + sut.imu_unheard + sut.imu_withheld, 500U);
    EXPECT_GT(sut.imu_withheld, 240U);  // every second one of the 200 Hz, and those from while it was configured
    EXPECT_GT(received, 200U);
    EXPECT_LE(received, sut.imu_rows);  // what it sent before it was told anything went to the conversation
    EXPECT_EQ(stream.summary().missing + stream.summary().refused, 0U);
  }
}

TEST_F(ToNetwork, KeepsTheTerminalUntilASlowReaderHasTakenAll) {
  write_imu(500);
  const Recording recording = made_recording(2000);
  options_.imu_terminal = folder_ / "imu";
  transport::SerialPort port({folder_ / "imu"});
  imu::CsvRows rows;
  std::uint64_t received = 0;
  const Duration end = clock_.now() + milliseconds(2520);  // of all that is sent
  clock_.while_asleep = [&] {
    drain();
    if (!port.is_open()) {
      ASSERT_EQ(port.open(), 0);
    } else if (clock_.now() > end) {
      rows.add_stream(port.read(), Stamp{}, [&](const sensor::ImuReading&) { ++received; });
    }
  };

  const ToNetworkReport sut = send(recording);

  EXPECT_EQ(sut.imu_rows, 500U);
  EXPECT_EQ(received, 500U);
}

TEST_F(ToNetwork, KeepsTheOrderOfACaptureWhoseStampsGoBack) {
  write_imu(10);
  const Recording recording = made_recording(0);
  recording::PcapWriter writer(recording.lidar);
  for (const int at_ms : {100, 900, 300, 1000}) {
    std::vector<std::byte> numbered(1206, static_cast<std::byte>(at_ms / 10));
    Packet packet;
    packet.received = kBegin + milliseconds(at_ms);
    packet.destination_port = 2368;
    packet.payload = numbered;
    writer.write(packet);
    sent_data_.push_back(numbered);
  }
  writer.close();

  const ToNetworkReport sut = send(recording);

  EXPECT_TRUE(data_.payloads == sent_data_);
  EXPECT_EQ(sut.worst_lateness, Duration(0));
}

TEST_F(ToNetwork, CountsRowsThatNobodyReadsFromTheTerminal) {
  write_imu(100);
  options_.imu_terminal = folder_ / "imu";

  const ToNetworkReport sut = send(made_recording(400));

  EXPECT_EQ(sut.imu_rows, 0U);
  EXPECT_EQ(sut.imu_unheard, 100U);
}

TEST_F(ToNetwork, TakesThePlaceOfAnOldLinkButOfNothingElse) {
  write_imu(10);
  const Recording recording = made_recording(10);
  std::filesystem::create_symlink("/dev/pts/none", folder_ / "imu");
  options_.imu_terminal = folder_ / "imu";
  EXPECT_EQ(send(recording).imu_unheard, 10U);

  options_.imu_terminal = write("precious", "data");

  EXPECT_EQ(scratch::message_of<std::runtime_error>([&] { send(recording); }),
            (folder_ / "precious").string() + ": is there already, and no link");
  EXPECT_EQ(text_of(folder_ / "precious"), "data");
}

TEST_F(ToNetwork, EndsWithExactCountsWhenItIsInterrupted) {
  write_imu(10);
  int asked = 0;

  const ToNetworkReport sut = send(made_recording(1000), [&] { return ++asked > 500; });

  EXPECT_TRUE(sut.interrupted);
  EXPECT_GT(sut.lidar, 50U);
  EXPECT_LT(sut.lidar, 500U);
  EXPECT_EQ(sut.lidar, data_.payloads.size());
  EXPECT_EQ(sut.position, position_.payloads.size());
  EXPECT_GE(sut.mean_lateness, Duration(0));
}

TEST_F(ToNetwork, TellsPacketsOfABuiltInImuFromPoints) {
  recording::PcapWriter writer(folder_ / "lidar.pcap");
  for (int i = 0; i < 30; ++i) {
    std::vector<std::byte> payload(i % 3 == 0 ? 42 : 1362);
    payload[0] = std::byte{5};
    payload[9] = std::byte{i % 3 == 0 ? std::uint8_t{6} : std::uint8_t{2}};
    Packet packet;
    packet.received = kBegin + milliseconds(i);
    packet.destination_port = 56001;
    packet.payload = payload;
    writer.write(packet);
  }
  writer.close();
  write("recording.toml", "[[lidar]]\nmodel = \"livox_avia\"\n[imu]\nsource = \"livox\"\n");

  const ToNetworkReport sut = send(open_recording(folder_, {}, {}));

  EXPECT_EQ(sut.imu_packets, 10U);
  EXPECT_EQ(sut.lidar, 20U);
  EXPECT_EQ(data_.payloads.size(), 30U);
}

TEST_F(ToNetwork, SendsTheInertialPacketsOfAMid360ToTheirOwnPort) {
  recording::PcapWriter writer(folder_ / "lidar.pcap");
  for (int i = 0; i < 30; ++i) {
    const bool inertial = i % 3 == 0;
    std::vector<std::byte> payload(inertial ? 60 : 1380);
    payload[10] = std::byte{inertial ? std::uint8_t{0} : std::uint8_t{1}};
    Packet packet;
    packet.received = kBegin + milliseconds(i);
    packet.destination_port = inertial ? 56401 : 56301;
    packet.payload = payload;
    writer.write(packet);
  }
  writer.close();
  write("recording.toml", "[[lidar]]\nmodel = \"livox_mid360\"\nport = 56301\n[imu]\nsource = \"livox\"\n");

  const ToNetworkReport sut = send(open_recording(folder_, {}, {}));
  position_.drain(Duration{});

  EXPECT_EQ(sut.imu_packets, 10U);
  EXPECT_EQ(sut.lidar, 20U);
  EXPECT_EQ(data_.payloads.size(), 20U);
  EXPECT_EQ(position_.payloads.size(), 10U);
}

TEST_F(ToNetwork, KeepsTheRecordedPortsUnlessOthersAreNamed) {
  write_imu(10);
  Recording recording = made_recording(3);
  Listener own;
  recording::PcapWriter writer(recording.lidar);
  const std::vector<std::byte> payload(1206);
  Packet packet;
  packet.received = kBegin;
  packet.destination_port = own.port();
  packet.payload = payload;
  writer.write(packet);
  writer.close();
  recording.configuration.lidar.port = own.port();
  options_.data_port = 0;

  send(recording);
  own.drain(Duration{});

  EXPECT_EQ(own.payloads.size(), 1U);
}

TEST_F(ToNetwork, RefusesAFolderOfClouds) {
  write("clouds/recording.toml", "[[lidar]]\nmodel = \"points\"\n");
  const Recording recording = open_recording(folder_ / "clouds", {}, {});

  EXPECT_NE(scratch::message_of<recording::RecordingError>([&] { send(recording); }).find("has no packets to send"),
            std::string::npos);
}

TEST_F(ToNetwork, ReportsItsCountsAsJson) {
  ToNetworkReport report;
  report.lidar = 7;
  report.imu_rows = 5;
  report.imu_unheard = 2;
  report.worst_lateness = microseconds(1500);

  const auto sut = nlohmann::json::parse(json_of(report));

  EXPECT_EQ(sut["sent"]["lidar"], 7);
  EXPECT_EQ(sut["sent"]["imu_rows"], 5);
  EXPECT_EQ(sut["not_sent"]["imu_unheard"], 2);
  EXPECT_EQ(sut["lateness_ms"]["worst"], 1.5);
  EXPECT_NE(summary_of(report).find("2 inertial rows that nobody read"), std::string::npos);
}

TEST(MonotonicSendClock, SleepsUntilItsDeadline) {
  MonotonicSendClock sut;
  const Duration deadline = sut.now() + milliseconds(20);

  sut.sleep_until(deadline);

  EXPECT_GE(sut.now(), deadline);
}

TEST(Destination, ReadsHostAndPorts) {
  ToNetworkOptions sut;

  parse_destination("--to-network", "10.1.2.3:4000:5000", sut);
  parse_imu_destination("udp:localhost:7501", sut);
  EXPECT_EQ(sut.address, 0x0A010203U);
  EXPECT_EQ(sut.data_port, 4000);
  EXPECT_EQ(sut.position_port, 5000);
  EXPECT_EQ(sut.imu_address, kLoopback);
  EXPECT_EQ(sut.imu_port, 7501);

  parse_destination("--to-network", "10.1.2.3", sut);
  parse_imu_destination("pty:/run/a:b", sut);
  EXPECT_EQ(sut.data_port, 0);
  EXPECT_EQ(sut.position_port, 0);
  EXPECT_EQ(sut.imu_terminal, "/run/a:b");
  EXPECT_EQ(sut.imu_protocol, imu::Protocol::kCsv);
  parse_imu_destination("xsens:/run/a:b", sut);
  EXPECT_EQ(sut.imu_terminal, "/run/a:b");
  EXPECT_EQ(sut.imu_protocol, imu::Protocol::kXsens);
  parse_imu_destination("mip:imu", sut);
  EXPECT_EQ(sut.imu_terminal, "imu");
  EXPECT_EQ(sut.imu_protocol, imu::Protocol::kMip);
}

TEST(Destination, RefusesWhatIsNone) {
  ToNetworkOptions sut;

  for (const char* text : {"", ":2368", "10.1.2.3:0", "10.1.2.3:65536", "10.1.2.3:x", "10.1.2.3:1:2:3"}) {
    EXPECT_THROW(parse_destination("--to-network", text, sut), cli::UsageError) << text;
  }
  for (const char* text : {"", "udp", "udp:10.1.2.3", "udp:10.1.2.3:0", "pty", "pty:", "xsens:", "mip", "csv:/run/imu", "tcp:10.1.2.3:7"}) {
    EXPECT_THROW(parse_imu_destination(text, sut), cli::UsageError) << text;
  }
}

}  // namespace
}  // namespace slamd::replay
