#include "tools/replay/emulated_imu.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "drivers/imu/line_setup.hpp"

namespace slamd::replay {
namespace {

using imu::Protocol;
using sensor::ImuSample;

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
constexpr Duration kPeriod = std::chrono::microseconds{2'500};

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

ImuSample sample(int i) { return {kBegin + i * kPeriod, {0.125, -0.25, 0.001 * i}, {0.5, -0.5, 9.8}}; }

/// What a host decodes of `count` samples.
std::vector<sensor::ImuReading> readings_of(EmulatedImu& device, Protocol protocol, int count) {
  imu::ImuStream stream(protocol);
  std::vector<sensor::ImuReading> readings;
  std::string bytes = device.greeting();
  for (int i = 0; i < count; ++i) {
    device.sample(sample(i), bytes);
  }
  stream.add(bytes_of(bytes), Stamp{}, [&](const sensor::ImuReading& reading) { readings.push_back(reading); });
  EXPECT_EQ(stream.summary().refused + stream.summary().missing, 0U);
  return readings;
}

TEST(EmulatedImu, SendsWhatAHostReadsBackBeforeItIsToldAnything) {
  for (const Protocol protocol : {Protocol::kCsv, Protocol::kXsens, Protocol::kMip}) {
    const auto sut = emulated_imu(protocol, 400);

    const auto readings = readings_of(*sut, protocol, 400);

    ASSERT_EQ(readings.size(), 400U) << name_of(protocol);
    for (int i = 0; i < 400; ++i) {
      const auto& reading = readings[static_cast<std::size_t>(i)];
      EXPECT_LT((reading.angular_rate_radps - sample(i).angular_rate_radps).norm(), 1e-7);
      EXPECT_LT((reading.specific_force_mps2 - sample(i).specific_force_mps2).norm(), 1e-6);
      EXPECT_EQ(reading.device_stamp - readings[0].device_stamp, i * kPeriod);
    }
  }
}

TEST(EmulatedImu, IsConfiguredByItsHost) {
  for (const Protocol protocol : {Protocol::kXsens, Protocol::kMip}) {
    const auto sut = emulated_imu(protocol, 400);
    imu::LineSetup host({protocol, 921'600, 100});
    imu::LineOutput to_device;
    host.begin(kBegin, to_device);
    int rounds = 0;
    std::uint32_t promised_hz = 0;

    for (; rounds < 10 && !host.is_ready(); ++rounds) {
      std::string answer;
      sut->hear(to_device.bytes.view(), answer);
      to_device = {};
      host.receive(bytes_of(answer), kBegin, to_device);
      for (const imu::LineEvent& event : to_device.events) {
        promised_hz = event.kind == imu::LineEvent::Kind::kConfigured ? event.value : 0;
      }
    }

    EXPECT_TRUE(host.is_ready()) << name_of(protocol);
    EXPECT_EQ(promised_hz, 100U);
    EXPECT_EQ(readings_of(*sut, protocol, 400).size(), 100U);
  }
}

TEST(EmulatedImu, SendsNothingWhileItIsConfigured) {
  const auto xsens = emulated_imu(Protocol::kXsens, 400);
  const auto mip = emulated_imu(Protocol::kMip, 400);
  const std::byte idle[] = {std::byte{2}, std::byte{imu::mip::kIdle}};
  std::string answers;
  xsens->hear(imu::write_xbus({imu::xbus::kGoToConfig, {}}).view(), answers);
  mip->hear(imu::write_mip({imu::mip::kBaseCommands, idle}).view(), answers);
  const std::size_t before = answers.size();

  EXPECT_FALSE(xsens->sample(sample(0), answers));
  EXPECT_FALSE(mip->sample(sample(0), answers));

  EXPECT_EQ(answers.size(), before);
}

TEST(EmulatedImu, RefusesWhatItDoesNotKnow) {
  const auto xsens = emulated_imu(Protocol::kXsens, 400);
  const auto mip = emulated_imu(Protocol::kMip, 400);
  std::string answer;
  xsens->hear(imu::write_xbus({imu::xbus::kGoToConfig, {}}).view(), answer);
  answer.clear();

  xsens->hear(imu::write_xbus({0xAA, {}}).view(), answer);
  EXPECT_EQ(imu::Xbus::parse(bytes_of(answer)).id, imu::xbus::kError);

  answer.clear();
  constexpr imu::MipOutput kOverrange[] = {{imu::mip::kOverrange, 1}};
  mip->hear(imu::write_message_format(kOverrange).view(), answer);
  const auto ack = imu::ack_of(imu::Mip::parse(bytes_of(answer)));
  ASSERT_TRUE(ack);
  EXPECT_EQ(ack->code, 3);
}

}  // namespace
}  // namespace slamd::replay
