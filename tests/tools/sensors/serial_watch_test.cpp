#include "tools/sensors/serial_watch.hpp"

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "drivers/gnss/nmea.hpp"
#include "made_bytes.hpp"

namespace slamd::sensors {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(10);

class SerialWatchTest : public testing::Test {
 protected:
  /// A device that says `next(i)` each 10 ms, at `baud`; at other rates noise comes of it.
  template <typename Next>
  void listen(Duration time, int baud, Next&& next) {
    for (const Stamp end = now_ + time; now_ < end; now_ += kTick) {
      const Bytes bytes = next(number_++);
      sut_.take(sut_.baud() == baud ? bytes : noise(bytes.size()), now_);
      changes_ += sut_.advance(now_) ? 1 : 0;
    }
    sut_.end_second();
  }

  Bytes noise(std::size_t size) {
    Bytes bytes(size);
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(random_());
    }
    return bytes;
  }

  std::mt19937 random_{5};
  Stamp now_ = kBegin;
  SerialWatch sut_{kBegin};
  std::uint32_t number_ = 0;
  int changes_ = 0;
};

Bytes rmc_and_gga(std::uint32_t number) {
  gnss::Rmc rmc;
  rmc.time_of_day = std::chrono::seconds(number);
  rmc.valid = true;
  rmc.place = gnss::Place{48.0, 11.0};
  gnss::Gga gga;
  gga.time_of_day = rmc.time_of_day;
  gga.place = rmc.place;
  gga.quality = 1;
  gga.satellites = 9;
  gga.hdop = 0.9;
  gga.altitude_m = 500.0;
  gga.separation_m = 47.0;
  return text_bytes(write_rmc(rmc) + write_gga(gga));
}

TEST_F(SerialWatchTest, FindsAnXsensAtTheFirstRate) {
  listen(std::chrono::seconds(1), 115'200, [](std::uint32_t i) { return xsens_message(100 * i); });

  const LineSeen seen = sut_.seen();
  EXPECT_EQ(seen.tongue, Tongue::kXsens);
  EXPECT_TRUE(seen.found);
  EXPECT_EQ(seen.baud, 115'200);
  EXPECT_EQ(seen.imu.samples, (Count{100, 100}));
  EXPECT_TRUE(seen.imu.shows_gravity());
}

TEST_F(SerialWatchTest, FindsAMicroStrainAtAnotherRate) {
  listen(std::chrono::seconds(10), 460'800, [](std::uint32_t i) { return mip_packet(std::uint64_t{10'000'000} * i); });

  const LineSeen seen = sut_.seen();
  EXPECT_EQ(seen.tongue, Tongue::kMip);
  EXPECT_EQ(seen.baud, 460'800);
  EXPECT_EQ(changes_, 2);
  EXPECT_GT(seen.imu.samples.total, 700U);
}

TEST_F(SerialWatchTest, FindsRowsOfCsv) {
  listen(std::chrono::seconds(1), 115'200, [](std::uint32_t i) {
    return text_bytes(std::to_string(10'000'000ULL * i) + ",0,0,0,0,0,9.81\n");
  });

  EXPECT_EQ(sut_.seen().tongue, Tongue::kCsv);
  EXPECT_GE(sut_.seen().imu.samples.total, 98U);
}

TEST_F(SerialWatchTest, FindsAReceiverAndItsFixes) {
  std::uint32_t second = 0;
  listen(std::chrono::seconds(20), 9'600, [&](std::uint32_t i) { return i % 100 == 0 ? rmc_and_gga(second++) : Bytes{}; });

  const LineSeen seen = sut_.seen();
  EXPECT_EQ(seen.tongue, Tongue::kGnss);
  EXPECT_EQ(seen.baud, 9'600);
  EXPECT_GE(seen.gnss.good.total, 4U);
  EXPECT_EQ(seen.gnss.satellites, 9U);
  EXPECT_EQ(seen.gnss.ubx.total, 0U);
  EXPECT_GE(seen.gnss.sentences.total, 10U);
}

TEST_F(SerialWatchTest, SaysWhyThereIsNoFix) {
  listen(std::chrono::seconds(2), 115'200, [](std::uint32_t i) {
    gnss::Gga gga;
    gga.time_of_day = std::chrono::seconds(i);
    gga.satellites = 3;
    return i % 100 == 0 ? text_bytes(write_gga(gga) + write_gga(gga)) : Bytes{};
  });

  EXPECT_EQ(sut_.seen().tongue, Tongue::kGnss);
  EXPECT_EQ(sut_.seen().gnss.good.total, 0U);
}

TEST_F(SerialWatchTest, TakesNoiseForNothingAndGoesOn) {
  listen(std::chrono::seconds(14), 1, [this](std::uint32_t) { return noise(40); });

  const LineSeen seen = sut_.seen();
  EXPECT_EQ(seen.tongue, Tongue::kNone);
  EXPECT_FALSE(seen.found);
  EXPECT_EQ(seen.rounds, 1);
  EXPECT_EQ(seen.bytes.total, 1400U * 40U);
}

TEST_F(SerialWatchTest, LooksForAnotherDeviceWhenTheFirstHasFallenSilent) {
  listen(std::chrono::seconds(1), 115'200, [](std::uint32_t i) { return xsens_message(100 * i); });
  listen(std::chrono::seconds(6), 115'200, [](std::uint32_t) { return Bytes{}; });
  EXPECT_EQ(sut_.seen().tongue, Tongue::kNone);

  listen(std::chrono::seconds(14), 115'200, [](std::uint32_t i) { return mip_packet(std::uint64_t{10'000'000} * i); });

  EXPECT_EQ(sut_.seen().tongue, Tongue::kMip);
}

TEST_F(SerialWatchTest, AsksOnceAtEachRateAndOnlyWhereNobodySpeaks) {
  EXPECT_TRUE(sut_.take_question(now_).empty());
  now_ += std::chrono::milliseconds(300);

  const auto question = sut_.take_question(now_);
  const auto again = sut_.take_question(now_);

  EXPECT_FALSE(question.empty());
  EXPECT_TRUE(again.empty());
}

TEST_F(SerialWatchTest, KnowsAMuteDeviceByItsAnswer) {
  now_ += std::chrono::milliseconds(300);
  sut_.take_question(now_);

  sut_.take(bytes_of(imu::write_xbus({imu::xbus::kGoToMeasurement + 1, {}})), now_);

  EXPECT_EQ(sut_.seen().tongue, Tongue::kXsens);
  EXPECT_TRUE(sut_.seen().answers);
  EXPECT_FALSE(sut_.advance(now_ + std::chrono::seconds(20)));
}

}  // namespace
}  // namespace slamd::sensors
