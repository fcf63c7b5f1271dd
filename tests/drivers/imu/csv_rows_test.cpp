#include "drivers/imu/csv_rows.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

using sensor::ImuReading;

constexpr Stamp kNow = Stamp{} + std::chrono::hours(500'000);

const std::string kRow = "1700000000123456789,0.1,-0.2,0.3,1.5,-2.5,9.81";

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

std::vector<ImuReading> from_datagram(CsvRows& rows, const std::string& text) {
  std::vector<ImuReading> readings;
  rows.add_datagram(bytes_of(text), kNow, [&](const ImuReading& reading) { readings.push_back(reading); });
  return readings;
}

std::vector<ImuReading> from_stream(CsvRows& rows, const std::string& text) {
  std::vector<ImuReading> readings;
  rows.add_stream(bytes_of(text), kNow, [&](const ImuReading& reading) { readings.push_back(reading); });
  return readings;
}

std::uint64_t total(const RowCounters& counters) {
  return std::accumulate(counters.rows.begin(), counters.rows.end(), std::uint64_t{0});
}

std::string number(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string row_of(const ImuReading& reading) {
  std::string row = std::to_string(reading.device_stamp.time_since_epoch().count());
  for (const double value : {reading.angular_rate_radps.x(), reading.angular_rate_radps.y(), reading.angular_rate_radps.z(),
                             reading.specific_force_mps2.x(), reading.specific_force_mps2.y(), reading.specific_force_mps2.z()}) {
    row += "," + number(value);
  }
  return row;
}

TEST(CsvRows, DecodesARow) {
  CsvRows sut;

  const auto readings = from_datagram(sut, kRow);

  ASSERT_EQ(readings.size(), 1U);
  EXPECT_EQ(readings[0].device_stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(readings[0].received, kNow);
  EXPECT_EQ(readings[0].angular_rate_radps, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(readings[0].specific_force_mps2, Eigen::Vector3d(1.5, -2.5, 9.81));
}

TEST(CsvRows, DecodesEachRowOfADatagramWhateverItsLineEnds) {
  CsvRows sut;

  EXPECT_EQ(from_datagram(sut, kRow + "\r\n" + kRow + ",31.5\n\n" + kRow).size(), 3U);
  EXPECT_EQ(sut.counters().of(RowResult::kOk), 3U);
  EXPECT_EQ(total(sut.counters()), 3U);
}

TEST(CsvRows, CountsBadRowsByReasonAndGoesOn) {
  CsvRows sut;

  const auto readings = from_datagram(sut,
                                      "1,2,3\n"                                // columns
                                      "1,0,0,0,0,0,9.8,20,7\n"                 // columns
                                      "timestamp_ns,gx,gy,gz,ax,ay,az\n"       // no number
                                      "1,0,0,,0,0,9.8\n"                       // no number
                                      "1,0,0,nan,0,0,9.8\n"                    // no number
                                      "1,0,0,0,inf,0,9.8\n"                    // no number
                                      "1.5,0,0,0,0,0,9.8\n"                    // no integer
                                      "-1,0,0,0,0,0,9.8\n"                     // stamp
                                      "9223372036854775807,0,0,0,0,0,9.8\n"    // stamp
                                      "1,0,0,0,0,0,9800\n" +                   // range: mm/s^2
                                          std::string(300, '1') + "\n" + kRow);

  EXPECT_EQ(readings.size(), 1U);
  EXPECT_EQ(sut.counters().of(RowResult::kWrongColumns), 2U);
  EXPECT_EQ(sut.counters().of(RowResult::kNotANumber), 5U);
  EXPECT_EQ(sut.counters().of(RowResult::kStampOutOfRange), 2U);
  EXPECT_EQ(sut.counters().of(RowResult::kTooLong), 1U);
  EXPECT_EQ(sut.counters().of(RowResult::kOutOfRange), 1U);
  EXPECT_EQ(total(sut.counters()), 12U);
}

TEST(CsvRows, PassesOverTheRowInWhoseMiddleAStreamBegins) {
  CsvRows sut;

  // "56789,..." would be a good row with a wrong stamp.
  const auto readings = from_stream(sut, kRow.substr(14) + "\n" + kRow + "\n");

  ASSERT_EQ(readings.size(), 1U);
  EXPECT_EQ(readings[0].device_stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(sut.counters().of(RowResult::kFragment), 1U);
}

TEST(CsvRows, KeepsTheFirstRowOfAStreamThatBeginsWithALineEnd) {
  CsvRows sut;

  EXPECT_EQ(from_stream(sut, "\n" + kRow + "\n").size(), 1U);
  EXPECT_EQ(total(sut.counters()), 1U);
}

TEST(CsvRows, ForgetsTheRowInHandWhenTheStreamIsInterrupted) {
  CsvRows sut;
  from_stream(sut, "\n" + kRow + "\n" + kRow.substr(0, 20));

  sut.restart_stream();
  const auto readings = from_stream(sut, kRow.substr(14) + "\n" + kRow + "\n");

  EXPECT_EQ(readings.size(), 1U);
  EXPECT_EQ(sut.counters().of(RowResult::kOk), 2U);
  EXPECT_EQ(sut.counters().of(RowResult::kFragment), 2U);
}

TEST(CsvRows, ResynchronisesAtTheNextLineEndAfterGarbageOfAnyLength) {
  CsvRows sut;
  from_stream(sut, "\n");

  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(from_stream(sut, std::string(1000, 'x')).empty());
  }
  const auto readings = from_stream(sut, "\n" + kRow + "\n");

  EXPECT_EQ(readings.size(), 1U);
  EXPECT_EQ(sut.counters().of(RowResult::kTooLong), 1U);
}

RC_GTEST_PROP(CsvRows, ReadsBackWhatIsWrittenWhereverTheStreamIsCut, ()) {
  const auto numbers = *rc::gen::container<std::vector<std::int32_t>>(rc::gen::arbitrary<std::int32_t>());
  std::vector<ImuReading> written;
  std::string text = "\n";
  for (std::size_t i = 0; i + 6 < numbers.size(); i += 7) {
    const auto scaled = [&](std::size_t k) { return numbers[i + k] / 1.0e7; };
    ImuReading reading;
    reading.device_stamp = DeviceStamp{} + Duration(std::int64_t{2'000'000'000} * std::abs(std::int64_t{numbers[i]}));
    reading.angular_rate_radps = {scaled(1), scaled(2), scaled(3)};
    reading.specific_force_mps2 = {scaled(4), scaled(5), scaled(6)};
    written.push_back(reading);
    text += row_of(reading) + "\n";
  }
  CsvRows sut;

  std::vector<ImuReading> read;
  while (!text.empty()) {
    const auto piece = *rc::gen::inRange<std::size_t>(1, text.size() + 1);
    const auto more = from_stream(sut, text.substr(0, piece));
    read.insert(read.end(), more.begin(), more.end());
    text.erase(0, piece);
  }

  RC_ASSERT(read.size() == written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    RC_ASSERT(read[i].device_stamp == written[i].device_stamp);
    RC_ASSERT(read[i].angular_rate_radps == written[i].angular_rate_radps);
    RC_ASSERT(read[i].specific_force_mps2 == written[i].specific_force_mps2);
  }
}

RC_GTEST_PROP(CsvRows, AccountsForEachRowOfADatagramWhateverItsBytes, ()) {
  std::string text = kRow + "\n" + kRow + ",20\r\n" + kRow + "\n" + kRow;
  const auto mutations = *rc::gen::inRange(0, 20);
  for (int i = 0; i < mutations; ++i) {
    const auto place = *rc::gen::inRange<std::size_t>(0, text.size());
    switch (*rc::gen::inRange(0, 3)) {
      case 0: text[place] = *rc::gen::arbitrary<char>(); break;
      case 1: text.erase(place, 1); break;
      default: text.insert(place, 1, *rc::gen::elementOf(std::string(",\n\r 0-.e"))); break;
    }
  }
  std::uint64_t rows = 0;  // lines that are not blank
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    rows += text.substr(begin, end - begin).find_first_not_of(" \t\r") != std::string::npos ? 1 : 0;
    begin = end + 1;
  }
  CsvRows sut;

  const auto readings = from_datagram(sut, text);

  RC_ASSERT(total(sut.counters()) == rows);
  RC_ASSERT(sut.counters().of(RowResult::kOk) == readings.size());
  for (const ImuReading& reading : readings) {
    RC_ASSERT(reading.device_stamp >= DeviceStamp{});
    RC_ASSERT(reading.angular_rate_radps.allFinite() && reading.specific_force_mps2.allFinite());
  }
}

TEST(CsvRows, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  CsvRows sut;
  const std::string text = kRow + "\nnonsense\n" + kRow + "\n" + std::string(400, '7') + "\n";
  std::size_t readings = 0;

  const std::size_t allocations = support::count_allocations([&] {
    sut.add_datagram(bytes_of(text), kNow, [&](const ImuReading&) { ++readings; });
    sut.add_stream(bytes_of(text), kNow, [&](const ImuReading&) { ++readings; });
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(readings, 3U);
}

}  // namespace
}  // namespace slamd::imu
