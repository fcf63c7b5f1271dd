#include "drivers/clouds/conversion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/clouds/ply.hpp"
#include "written_cloud.hpp"

namespace slamd::clouds {
namespace {

// An ASCII PLY with x y z and one more property; parsed and converted.
struct Converted {
  std::optional<CloudRefusal> refusal;
  Cloud cloud;
};

Converted convert(CloudConverter& sut,
                  const std::string& type,
                  const std::string& name,
                  const std::vector<std::string>& values) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(values.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nproperty " + type +
                     " " + name + "\nend_header\n";
  for (const std::string& value : values) {
    text += "1 2 3 " + value + "\n";
  }
  const Written file(text);
  RawCloud raw;
  Converted result;
  EXPECT_EQ(parse_ply(file.bytes(), raw), std::nullopt);
  result.refusal = sut.convert(raw, result.cloud);
  return result;
}

std::vector<std::uint32_t> offsets(const Cloud& cloud) {
  std::vector<std::uint32_t> result;
  for (const sensor::Point& point : cloud.points) {
    result.push_back(point.offset_ns);
  }
  return result;
}

TEST(CloudConverter, FindsTheUnitOfTimeByItsMagnitude) {
  struct Case {
    const char* type;
    const char* name;
    std::vector<std::string> values;
  };

  for (const Case& c : {Case{"float", "time", {"0", "0.05", "0.0999"}},
                        Case{"double", "Timestamp", {"0", "50", "99.9"}},
                        Case{"uint", "t", {"0", "50000", "99900"}},
                        Case{"uint", "offset_time", {"0", "50000000", "99900000"}}}) {
    CloudConverter sut(true);

    const Converted result = convert(sut, c.type, c.name, c.values);

    ASSERT_EQ(result.refusal, std::nullopt);
    ASSERT_TRUE(result.cloud.has_time);
    EXPECT_NEAR(offsets(result.cloud)[1], 50'000'000, 4) << c.type;
    EXPECT_NEAR(static_cast<double>(result.cloud.span.count()), 99'900'000, 4);
    EXPECT_FALSE(result.cloud.absolute_time);
  }
}

TEST(CloudConverter, KeepsEveryNanosecondOfIntegerDates) {
  CloudConverter sut(true);

  const Converted result =
      convert(sut,
              "uint64",
              "timestamp",
              {"1700000000123456799", "1700000000123456789", "1700000000223456788"});

  ASSERT_TRUE(result.cloud.absolute_time);
  EXPECT_EQ(result.cloud.first_time.count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(offsets(result.cloud), (std::vector<std::uint32_t>{10, 0, 99'999'999}));
}

TEST(CloudConverter, ReadsDatesInSeconds) {
  CloudConverter sut(true);

  const Converted result = convert(sut, "double", "timestamp", {"1700000000.25", "1700000000.3"});

  EXPECT_TRUE(result.cloud.absolute_time);
  EXPECT_EQ(result.cloud.first_time.count(), 1'700'000'000'250'000'000);
  EXPECT_NEAR(offsets(result.cloud)[1], 50'000'000, 500);
}

TEST(CloudConverter, KeepsNegativeOffsetsRelativeToTheStamp) {
  CloudConverter sut(true);

  const Converted result = convert(sut, "float", "time", {"-0.1", "-0.05", "0"});

  EXPECT_NEAR(static_cast<double>(result.cloud.first_time.count()), -100'000'000, 10);
  EXPECT_EQ(offsets(result.cloud)[0], 0U);
}

TEST(CloudConverter, KeepsTheUnitForCloudsThatDoNotTell) {
  CloudConverter sut(true);
  convert(sut, "uint", "t", {"0", "99900"});

  const Converted shorter = convert(sut, "uint", "t", {"0", "3000"});
  const Converted longer = convert(sut, "uint", "t", {"0", "1500000"});

  EXPECT_EQ(offsets(shorter.cloud)[1], 3'000'000U);
  EXPECT_EQ(longer.refusal, CloudRefusal::kBadTime);
}

TEST(CloudConverter, TakesEqualTimesForNone) {
  CloudConverter sut(true);
  EXPECT_FALSE(convert(sut, "float", "t", {"0", "0"}).cloud.has_time);

  CloudConverter compensated(false);
  EXPECT_FALSE(convert(compensated, "float", "t", {"0", "0.1"}).cloud.has_time);
}

TEST(CloudConverter, RefusesTimesThatAreNoNumbers) {
  CloudConverter sut(true);
  EXPECT_EQ(convert(sut, "float", "t", {"0", "0.1", "nan"}).refusal, CloudRefusal::kBadTime);
}

TEST(CloudConverter, ScalesIntensityOfOneAndCutsTheRest) {
  CloudConverter sut(true);

  const Converted unit = convert(sut, "float", "intensity", {"0", "0.5", "1", "nan", "-1"});
  const Converted bytes = convert(sut, "float", "Intensity", {"0", "0.5", "77", "1000"});
  const Converted integers = convert(sut, "uchar", "reflectivity", {"0", "1"});

  const auto intensities = [](const Cloud& cloud) {
    std::vector<int> result;
    for (const sensor::Point& point : cloud.points) {
      result.push_back(point.intensity);
    }
    return result;
  };
  EXPECT_EQ(intensities(unit.cloud), (std::vector<int>{0, 127, 255, 0, 0}));
  EXPECT_EQ(intensities(bytes.cloud), (std::vector<int>{0, 0, 77, 255}));
  EXPECT_EQ(intensities(integers.cloud), (std::vector<int>{0, 1}));
}

TEST(CloudConverter, LeavesOutPointsWithoutAReturn) {
  const Written file(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar ring\nend_header\n"
      "0 0 0 1\nnan 1 2 2\n1 2 3 3\ninf 0 0 4\n1e30 0 0 5\n");
  RawCloud raw;
  ASSERT_EQ(parse_ply(file.bytes(), raw), std::nullopt);
  CloudConverter sut(true);
  Cloud cloud;

  ASSERT_EQ(sut.convert(raw, cloud), std::nullopt);

  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_EQ(cloud.points[0].line, 3);
  EXPECT_EQ(cloud.lines, LineSource::kField);
  EXPECT_EQ(cloud.empty, 4U);
}

TEST(CloudConverter, TakesTheRowsOfAnOrganisedCloudForLines) {
  RawCloud raw;
  const Written file = [] {
    Written points;
    for (int i = 0; i < 12; ++i) {
      points.add_le(i == 4 ? NAN : 1.0F).add_le(2.0F).add_le(3.0F).add_le(0.0F);
    }
    return points;
  }();
  ASSERT_EQ(parse_bin(file.bytes(), raw), std::nullopt);
  raw.height = 3;
  CloudConverter sut(true);
  Cloud cloud;

  ASSERT_EQ(sut.convert(raw, cloud), std::nullopt);

  EXPECT_EQ(cloud.lines, LineSource::kRows);
  ASSERT_EQ(cloud.points.size(), 11U);
  EXPECT_EQ(cloud.points[3].line, 0);
  EXPECT_EQ(cloud.points[4].line, 1);  // the empty one is left out, not moved up
  EXPECT_EQ(cloud.points[6].line, 1);
  EXPECT_EQ(cloud.points[7].line, 2);
}

TEST(CloudConverter, NamesMissingCoordinates) {
  const Written file("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n");
  RawCloud raw;
  ASSERT_EQ(parse_ply(file.bytes(), raw), std::nullopt);
  CloudConverter sut(true);
  Cloud cloud;

  EXPECT_EQ(sut.convert(raw, cloud), CloudRefusal::kNoCoordinates);
}

}  // namespace
}  // namespace slamd::clouds
