#include "drivers/imu/line_setup.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "stream_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

using Kind = LineEvent::Kind;

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
constexpr Duration kTick = std::chrono::milliseconds{10};
constexpr std::string_view kRow = "1000,0.1,0.2,0.3,0,0,9.81\n";

/// A line with a sensor that is heard at one rate only, and with time that passes in ticks.
class Line {
 public:
  Line(const LineSetupConfig& config, int sensor_baud) : sut(config), baud(sensor_baud) { sut.begin(now, out); }

  /// Lets ticks pass until the line is ready; each brings what speak() says, or garbage at a wrong rate.
  template <typename Speak>
  bool becomes_ready(Duration longest, Speak&& speak) {
    for (const Stamp end = now + longest; now < end && !sut.is_ready(); now += kTick) {
      const Bytes bytes = sut.baud() == baud ? speak(take_sent()) : Bytes(7, std::byte{0xF3});
      rest = bytes.size() - sut.receive(bytes, now, out);
      sut.advance(now, out);
      note_events();
    }
    return sut.is_ready();
  }

  void note_events() {
    for (const LineEvent& event : out.events) {
      events.push_back(event.kind);
      values.push_back(event.value);
    }
    out.events.clear();
  }

  std::string take_sent() {
    const std::string hex = to_hex(out.bytes.view());
    out.bytes.clear();
    return hex;
  }

  Stamp now = kBegin;
  LineOutput out;
  LineSetup sut;
  int baud;
  std::size_t rest = 0;  // bytes of the last tick that were left for the samples
  std::vector<Kind> events;
  std::vector<std::uint32_t> values;
};

Bytes text_bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

Bytes xsens_message(std::uint8_t id) {
  const XbusBytes bytes = write_xbus({id, {}});
  return {bytes.begin(), bytes.end()};
}

Bytes xsens_sample() {
  constexpr XsensOutput kOutputs[] = {{mt::kSampleTimeFine, 0}, {mt::kAcceleration, 0}, {mt::kRateOfTurn, 0}};
  const XbusBytes bytes = write_sample(kOutputs, {});
  return {bytes.begin(), bytes.end()};
}

/// What a device says to the one command that it has got.
Bytes xsens_answer(const std::string& sent) {
  return sent.size() < 6 ? Bytes{} : xsens_message(static_cast<std::uint8_t>(std::stoi(sent.substr(4, 2), nullptr, 16) + 1));
}

Bytes mip_answer(const std::string& sent) {
  if (sent.size() < 12) {
    return {};
  }
  const auto set = static_cast<std::uint8_t>(std::stoi(sent.substr(4, 2), nullptr, 16));
  const std::string command = sent.substr(10, 2);
  const Bytes payload = from_hex("04F1" + command + "00" + (command == "0E" ? "058E8001F4" : ""));
  const MipBytes bytes = write_mip({set, payload});
  return {bytes.begin(), bytes.end()};
}

TEST(LineSetup, IsReadyAtOnceWhereThereIsNothingToFindOrToTell) {
  LineOutput out;
  LineSetup rows({Protocol::kCsv, 115'200, 0});
  LineSetup xsens({Protocol::kXsens, 460'800, 0});

  rows.begin(kBegin, out);
  xsens.begin(kBegin, out);

  EXPECT_TRUE(rows.is_ready() && xsens.is_ready());
  EXPECT_EQ(xsens.baud(), 460'800);
  EXPECT_TRUE(out.bytes.empty());
}

TEST(LineSetup, FindsTheRateAtWhichRowsCome) {
  for (const int baud : {115'200, 921'600, 9'600}) {
    Line line({Protocol::kCsv, 0, 0}, baud);

    ASSERT_TRUE(line.becomes_ready(std::chrono::seconds{8}, [](const std::string&) { return text_bytes(kRow); })) << baud;

    EXPECT_EQ(line.sut.baud(), baud);
    EXPECT_EQ(line.events, std::vector<Kind>{Kind::kFound});
    EXPECT_EQ(line.values[0], static_cast<std::uint32_t>(baud));
  }
}

TEST(LineSetup, FindsTheRateOfASensorThatSpeaksWhenSpokenTo) {
  Line xsens({Protocol::kXsens, 0, 0}, 460'800);
  Line mip({Protocol::kMip, 0, 0}, 230'400);

  EXPECT_TRUE(xsens.becomes_ready(std::chrono::seconds{8}, xsens_answer));
  EXPECT_TRUE(mip.becomes_ready(std::chrono::seconds{8}, mip_answer));

  EXPECT_EQ(xsens.sut.baud(), 460'800);
  EXPECT_EQ(mip.sut.baud(), 230'400);
}

TEST(LineSetup, FindsTheRateAndThenConfigures) {
  Line xsens({Protocol::kXsens, 0, 400}, 921'600);
  Line mip({Protocol::kMip, 0, 250}, 921'600);

  ASSERT_TRUE(xsens.becomes_ready(std::chrono::seconds{8}, xsens_answer));
  ASSERT_TRUE(mip.becomes_ready(std::chrono::seconds{8}, mip_answer));

  EXPECT_EQ(xsens.events, (std::vector<Kind>{Kind::kFound, Kind::kConfigured}));
  EXPECT_EQ(mip.events, (std::vector<Kind>{Kind::kFound, Kind::kConfigured}));
  EXPECT_EQ(xsens.values[1], 400U);
  EXPECT_EQ(mip.values[1], 250U);
}

TEST(LineSetup, AsksForNoMoreSamplesThanTheLineCarries) {
  EXPECT_EQ(fitting_rate_hz(400, 921'600, XsensHost::kSampleBytes), 400);
  EXPECT_EQ(fitting_rate_hz(400, 230'400, XsensHost::kSampleBytes), 200);
  EXPECT_EQ(fitting_rate_hz(400, 115'200, XsensHost::kSampleBytes), 100);
  EXPECT_EQ(fitting_rate_hz(100, 9'600, XsensHost::kSampleBytes), 10);
  Line line({Protocol::kXsens, 115'200, 400}, 115'200);

  ASSERT_TRUE(line.becomes_ready(std::chrono::seconds{2}, xsens_answer));

  EXPECT_EQ(line.values, std::vector<std::uint32_t>{100});
}

TEST(LineSetup, LeavesWhatComesBehindTheLastAnswerForTheSamples) {
  Line line({Protocol::kXsens, 921'600, 400}, 921'600);

  ASSERT_TRUE(line.becomes_ready(std::chrono::seconds{2}, [](const std::string& sent) {
    Bytes bytes = xsens_answer(sent);
    if (sent == "FAFF1000F1") {
      const Bytes sample = xsens_sample();
      bytes.insert(bytes.end(), sample.begin(), sample.end());
    }
    return bytes;
  }));

  EXPECT_EQ(line.rest, xsens_sample().size());
}

TEST(LineSetup, TakesASensorAsItIsThatSendsAndDoesNotAnswer) {
  Line line({Protocol::kXsens, 921'600, 400}, 921'600);

  EXPECT_TRUE(line.becomes_ready(std::chrono::seconds{2}, [](const std::string&) { return xsens_sample(); }));

  EXPECT_EQ(line.events, std::vector<Kind>{Kind::kTakenAsItIs});
}

TEST(LineSetup, SaysThatASensorIsMuteAndFindsItWhenItComes) {
  for (const int baud : {0, 921'600}) {
    Line line({Protocol::kMip, baud, 250}, 921'600);

    EXPECT_FALSE(line.becomes_ready(std::chrono::seconds{7}, [](const std::string&) { return Bytes{}; }));
    ASSERT_FALSE(line.events.empty());
    EXPECT_EQ(line.events.front(), Kind::kMute);
    EXPECT_TRUE(line.becomes_ready(std::chrono::seconds{8}, mip_answer));

    EXPECT_EQ(line.events.back(), Kind::kConfigured);
  }
}

TEST(LineSetup, TellsWhatTheSensorRefuses) {
  Line line({Protocol::kXsens, 921'600, 400}, 921'600);

  ASSERT_TRUE(line.becomes_ready(std::chrono::seconds{2}, [](const std::string& sent) {
    if (sent.rfind("FAFFC0", 0) == 0) {
      const Bytes code{std::byte{0x1E}};
      const XbusBytes error = write_xbus({xbus::kError, code});
      return Bytes(error.begin(), error.end());
    }
    return xsens_answer(sent);
  }));

  EXPECT_EQ(line.events, std::vector<Kind>{Kind::kRefused});
  EXPECT_EQ(line.values, std::vector<std::uint32_t>{0x1E});
}

TEST(LineSetup, BeginsAnewWhenThePortIsOpenedAgain) {
  Line line({Protocol::kXsens, 0, 400}, 460'800);
  ASSERT_TRUE(line.becomes_ready(std::chrono::seconds{8}, xsens_answer));

  line.sut.begin(line.now, line.out);
  EXPECT_FALSE(line.sut.is_ready());

  EXPECT_EQ(line.sut.baud(), 460'800);  // first
  EXPECT_TRUE(line.becomes_ready(std::chrono::seconds{1}, xsens_answer));
}

TEST(LineSetup, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  LineSetup sut({Protocol::kXsens, 0, 400});
  LineOutput out;
  const Bytes sample = xsens_sample();
  const Bytes answer = xsens_message(xbus::kGoToConfig + 1);

  const std::size_t allocations = support::count_allocations([&] {
    sut.begin(kBegin, out);
    sut.receive(sample, kBegin, out);
    sut.receive(sample, kBegin, out);
    sut.receive(answer, kBegin, out);
    sut.advance(kBegin + std::chrono::seconds{1}, out);
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::imu
