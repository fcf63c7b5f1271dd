#include "daemon/stages/gnss_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "core/base/bytes.hpp"
#include "daemon/stages/packet_stage.hpp"
#include "drivers/gnss/nmea.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::stages {
namespace {

using namespace std::chrono_literals;

constexpr Stamp kBegin{1'700'000'000s};

std::string sentence_at(int second, char status = 'A') {
  char body[120];
  std::snprintf(body, sizeof body, "GPRMC,1011%02d,%c,5224.000,N,01331.000,E,1.0,90.0,230326,,", second, status);
  return gnss::framed(body);
}

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

TEST(GnssStage, TellsBytesMessagesAndFixesApart) {
  GnssStage sut;

  sut.add({}, kBegin);
  EXPECT_EQ(sut.state().last_bytes, Stamp{});
  sut.add(bytes_of("noise"), kBegin + 1s);
  EXPECT_EQ(sut.state().last_bytes, kBegin + 1s);
  EXPECT_EQ(sut.state().last_message, Stamp{});
  sut.add(bytes_of(sentence_at(1, 'V') + sentence_at(2, 'V')), kBegin + 2s);
  EXPECT_EQ(sut.state().last_message, kBegin + 2s);
  EXPECT_EQ(sut.state().fixes, 2U);
  EXPECT_EQ(sut.state().last_good, Stamp{});
  sut.add(bytes_of(sentence_at(3) + "$GPRMC,torn*00\r\n"), kBegin + 3s);

  EXPECT_EQ(sut.state().good, 1U);
  EXPECT_EQ(sut.state().last_good, kBegin + 3s);
  EXPECT_EQ(sut.state().damaged, 1U);
  EXPECT_TRUE(sut.state().has_fix());
}

TEST(GnssStage, SpansItsGoodFixesByTheReceiversTime) {
  GnssStage sut;

  sut.add(bytes_of(sentence_at(1) + sentence_at(2) + sentence_at(5) + sentence_at(6, 'V')), kBegin);

  EXPECT_EQ(sut.state().span(), 4s);
}

TEST(GnssStage, CountsNoMoreThanThereWas) {
  GnssStage sut;

  sut.add(bytes_of("??" + sentence_at(1) + sentence_at(2, 'V')), kBegin);
  sut.finish(kBegin);

  EXPECT_EQ(sut.counts(), (NamedCounts{{"fix", 1}, {"no_fix", 1}, {"skipped_bytes", 2}}));
}

TEST(GnssStage, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  GnssStage sut;
  const std::string text = sentence_at(1) + gnss::framed("GPGGA,101101,5224.0,N,01331.0,E,1,08,0.9,34.0,M,0.0,M,,") + sentence_at(2);

  EXPECT_EQ(support::count_allocations([&] { sut.add(bytes_of(text), kBegin); }), 0U);
  EXPECT_TRUE(sut.state().origin);
}

/// Position packets of a VLP-16, one for each sentence.
GnssState heard_behind_the_lidar(const std::string& source) {
  configuration::Configuration configuration;
  configuration.gnss.source = source;
  PacketStage sut(configuration);
  auto block = std::make_unique<sensor::PointBlock>();
  for (int i = 0; i < 12; ++i) {
    const std::string sentence = i < 2 ? std::string() : sentence_at(i / 4);  // each is sent several times
    std::vector<std::byte> payload(512);
    store_le(payload, 0xC6, static_cast<std::uint32_t>(250'000 * i));
    std::copy_n(bytes_of(sentence).begin(), sentence.size(), payload.begin() + 0xCE);
    recording::Packet packet;
    packet.received = kBegin + 250ms * i;
    packet.destination_port = 8308;
    packet.payload = payload;
    EXPECT_TRUE(sut.add(packet, *block).is_position);
  }
  return sut.gnss_stage().state();
}

TEST(GnssStage, HearsAReceiverBehindTheLidarWhereThatIsWanted) {
  const GnssState heard = heard_behind_the_lidar("velodyne");

  EXPECT_EQ(heard.good, 3U);
  EXPECT_EQ(heard.newest.stamp, kBegin + 2s);
  EXPECT_EQ(heard_behind_the_lidar("gnss.csv").fixes, 0U);
}

}  // namespace
}  // namespace slamd::stages
