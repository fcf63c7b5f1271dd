#include "drivers/storage/ply_writer.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "drivers/storage/ply_reader.hpp"
#include "tests/drivers/storage/full_disk.hpp"
#include "tests/drivers/storage/read_back.hpp"

namespace slamd::storage {
namespace {

class PlyWriterTest : public testing::Test {
 protected:
  PlyWriterTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::path(testing::TempDir()) / ("slamd_storage_" + std::string(test->name()) + ".ply");
    std::filesystem::remove(file_);
  }

  ~PlyWriterTest() override { std::filesystem::remove(file_); }

  std::string text() const {
    std::ifstream stream(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  std::filesystem::path file_;
};

template <typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_F(PlyWriterTest, WritesWhatItsReaderReadsBack) {
  PlyWriter sut(file_);
  sut.write({1.0F, -2.0F, 3.5F});
  sut.write({0.0F, 1e-3F, -1e6F});
  sut.close();

  PlyReader reader(file_);

  EXPECT_EQ(reader.read(), Eigen::Vector3f(1.0F, -2.0F, 3.5F));
  EXPECT_EQ(reader.read(), Eigen::Vector3f(0.0F, 1e-3F, -1e6F));
  EXPECT_NE(message_of([&] { reader.read(); }).find("ends"), std::string::npos);
}

TEST_F(PlyWriterTest, WritesTheCountIntoItsHeaderAndThePointsBehindIt) {
  PlyWriter sut(file_);

  sut.write({1.0F, -2.0F, 3.5F});
  sut.write({0.0F, 1e-3F, -1e6F});
  sut.close();

  EXPECT_EQ(sut.points(), 2U);
  const std::string written = text();
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 000000000002\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  ASSERT_EQ(written.size(), header.size() + 24);
  EXPECT_EQ(written.substr(0, header.size()), header);
  const auto body = std::as_bytes(std::span(written)).subspan(header.size());
  const float expected[] = {1.0F, -2.0F, 3.5F, 0.0F, 1e-3F, -1e6F};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(load_le<float>(body, 4 * i), expected[i]);
  }
}

TEST_F(PlyWriterTest, IsReadBackAsItWasWritten) {
  PlyWriter sut(file_);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 10'000; ++i) {
    points.emplace_back(0.1F * static_cast<float>(i), -static_cast<float>(i), 1.0F / static_cast<float>(i + 1));
  }
  points.emplace_back(std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min(), -0.0F);

  for (const Eigen::Vector3f& point : points) {
    sut.write(point);
  }
  sut.close();

  const auto read = read_back(file_);
  ASSERT_EQ(read.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(read[i], points[i].cast<double>()) << i;
  }
}

TEST_F(PlyWriterTest, WritesACloudWithoutAPoint) {
  PlyWriter sut(file_);

  sut.close();

  EXPECT_TRUE(read_back(file_).empty());
}

TEST_F(PlyWriterTest, ReplacesAnOlderFileWhole) {
  std::ofstream(file_) << std::string(5000, 'x');
  PlyWriter sut(file_);

  sut.write({1.0F, 2.0F, 3.0F});
  sut.close();

  EXPECT_EQ(text().find('x', 120), std::string::npos);
  EXPECT_LT(text().size(), 200U);
}

TEST_F(PlyWriterTest, ClosesTwiceAsOnce) {
  PlyWriter sut(file_);
  sut.write({1.0F, 2.0F, 3.0F});

  sut.close();
  const std::string once = text();
  sut.close();

  EXPECT_EQ(text(), once);
}

TEST_F(PlyWriterTest, TellsWhereItCannotBegin) {
  const std::string message = message_of([] { PlyWriter sut("/no/such/folder/map.ply"); });

  EXPECT_EQ(message, "/no/such/folder/map.ply: No such file or directory");
}

TEST_F(PlyWriterTest, TellsWhenTheDiskIsFullFromTheBeginning) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "/dev/full is not there";
  }
  PlyWriter sut("/dev/full");
  sut.write({1.0F, 2.0F, 3.0F});

  EXPECT_EQ(message_of([&] { sut.close(); }), "/dev/full: could not be written whole: No space left on device");
}

// The header can be written over even then; the points behind it are not all there.
TEST_F(PlyWriterTest, TellsWhenTheDiskBecomesFullAmongThePoints) {
  PlyWriter sut(file_);
  std::string message;

  {
    const FullDisk full(100'000);
    for (int i = 0; i < 20'000; ++i) {
      sut.write({1.0F, 2.0F, 3.0F});
    }
    message = message_of([&] { sut.close(); });
  }

  EXPECT_EQ(message, file_.string() + ": could not be written whole: File too large");
}

TEST_F(PlyWriterTest, RemembersThatTheDiskWasFullForAWhile) {
  PlyWriter sut(file_);
  const auto write_points = [&sut] {
    for (int i = 0; i < 20'000; ++i) {
      sut.write({1.0F, 2.0F, 3.0F});
    }
  };
  {
    const FullDisk full(100'000);
    write_points();
  }

  write_points();

  EXPECT_EQ(message_of([&] { sut.close(); }), file_.string() + ": could not be written whole: File too large");
}

}  // namespace
}  // namespace slamd::storage
