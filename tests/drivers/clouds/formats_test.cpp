#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "drivers/clouds/lzf.hpp"
#include "drivers/clouds/pcd.hpp"
#include "drivers/clouds/ply.hpp"
#include "written_cloud.hpp"

namespace slamd::clouds {
namespace {

using Bytes = std::vector<std::byte>;

std::string pcd_header(const std::string& encoding, std::size_t points) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z _ t ring\nSIZE 4 4 4 1 8 2\nTYPE F F F U U U\n"
         "COUNT 1 1 1 3 1 1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         std::to_string(points) + "\nDATA " + encoding + "\n";
}

constexpr std::uint64_t kTime = 1'700'000'000'123'456'789;

Bytes binary_pcd() {
  Written file(pcd_header("binary", 2));
  for (int i = 0; i < 2; ++i) {
    file.add_le(1.5F + static_cast<float>(i)).add_le(-2.0F).add_le(0.25F).add("abc");
    file.add_le(kTime + static_cast<std::uint64_t>(i)).add_le<std::uint16_t>(300);
  }
  return file.bytes();
}

Bytes compressed_pcd() {
  Written columns;
  columns.add_le(1.5F).add_le(2.5F).add_le(-2.0F).add_le(-2.0F).add_le(0.25F).add_le(0.25F);
  columns.add("abcabc").add_le(kTime).add_le(kTime + 1);
  columns.add_le<std::uint16_t>(300).add_le<std::uint16_t>(300);
  const Bytes packed = lzf_pack(columns.bytes());
  Written file(pcd_header("binary_compressed", 2));
  file.add_le(static_cast<std::uint32_t>(packed.size()));
  file.add_le(static_cast<std::uint32_t>(columns.bytes().size())).add(packed);
  return file.bytes();
}

Bytes ascii_pcd() {
  return Written(pcd_header("ascii", 2))
      .add("1.5 -2 0.25 97 98 99 1700000000123456789 300\r\n")
      .add("2.5 -2 2.5e-1 97 98 99 1700000000123456790 300\n")
      .bytes();
}

void expect_the_two_points(const RawCloud& cloud) {
  ASSERT_EQ(cloud.points, 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(cloud.number(*cloud.find("x"), i), 1.5 + static_cast<double>(i));
    EXPECT_EQ(cloud.number(*cloud.find("y"), i), -2.0);
    EXPECT_EQ(cloud.number(*cloud.find("z"), i), 0.25);
    EXPECT_EQ(cloud.integer(*cloud.find("t"), i), static_cast<std::int64_t>(kTime + i));
    EXPECT_EQ(cloud.integer(*cloud.find("ring"), i), 300);
  }
}

TEST(Pcd, ReadsBinary) {
  const Bytes file = binary_pcd();
  RawCloud sut;

  ASSERT_EQ(parse_pcd(file, sut), std::nullopt);

  expect_the_two_points(sut);
}

TEST(Pcd, ReadsBinaryCompressed) {
  const Bytes file = compressed_pcd();
  RawCloud sut;

  ASSERT_EQ(parse_pcd(file, sut), std::nullopt);

  expect_the_two_points(sut);
}

TEST(Pcd, ReadsAsciiWithEveryNanosecond) {
  const Bytes file = ascii_pcd();
  RawCloud sut;

  ASSERT_EQ(parse_pcd(file, sut), std::nullopt);

  expect_the_two_points(sut);
}

TEST(Pcd, ReadsNanInAscii) {
  const Bytes file =
      Written("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\nnan NaN -nan\n")
          .bytes();
  RawCloud sut;

  ASSERT_EQ(parse_pcd(file, sut), std::nullopt);

  EXPECT_TRUE(std::isnan(sut.number(*sut.find("x"), 0)));
}

TEST(Pcd, IgnoresBytesBehindTheLastPoint) {
  Bytes file = binary_pcd();
  file.resize(file.size() + 4096);
  RawCloud sut;

  EXPECT_EQ(parse_pcd(file, sut), std::nullopt);
  EXPECT_EQ(sut.points, 2U);
}

TEST(Pcd, RefusesCountsThatTheFileCannotHold) {
  RawCloud sut;
  const auto with_points = [](const std::string& encoding, const std::string& points) {
    return Written("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS " + points + "\nDATA " + encoding +
                   "\n1 2 3 4 5 6 7")
        .bytes();
  };

  for (const char* points : {"2", "4294967296", "1537228672809129302", "18446744073709551615"}) {
    EXPECT_EQ(parse_pcd(with_points("binary", points), sut), CloudRefusal::kTruncated) << points;
  }
  EXPECT_EQ(parse_pcd(with_points("ascii", "18446744073709551615"), sut), CloudRefusal::kTruncated);
  EXPECT_EQ(parse_pcd(with_points("binary", "18446744073709551616"), sut),
            CloudRefusal::kBadHeader);
  EXPECT_EQ(parse_pcd(with_points("binary", "-1"), sut), CloudRefusal::kBadHeader);
  EXPECT_EQ(parse_pcd(with_points("zip", "1"), sut), CloudRefusal::kUnsupported);
}

TEST(Pcd, RefusesHeadersThatContradictThemselves) {
  RawCloud sut;
  for (const char* header : {"",
                             "FIELDS x y z\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 0\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 0\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 0\nTYPE F F F\nPOINTS 0\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 4\nTYPE F F X\nPOINTS 0\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\nPOINTS 0\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 99999999999\n"
                             "POINTS 0\nDATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 3\nPOINTS 5\n"
                             "DATA binary\n",
                             "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4294967296\n"
                             "HEIGHT 4294967296\nDATA binary\n",
                             "hello\n"}) {
    EXPECT_EQ(parse_pcd(Written(header).bytes(), sut), CloudRefusal::kBadHeader) << header;
  }
}

TEST(Pcd, RefusesEveryTruncation) {
  RawCloud sut;
  for (const Bytes& whole : {binary_pcd(), compressed_pcd()}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_NE(parse_pcd(cut, sut), std::nullopt) << size;
    }
  }
  const Bytes ascii = ascii_pcd();
  for (std::size_t size = 0; size + 5 < ascii.size(); ++size) {  // "3" is a ring, too
    const Bytes cut(ascii.begin(), ascii.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_NE(parse_pcd(cut, sut), std::nullopt) << size;
  }
}

TEST(Pcd, RefusesCompressionThatPromisesTheImpossible) {
  Bytes file = compressed_pcd();
  const std::size_t body =
      file.size() - (compressed_pcd().size() - pcd_header("binary_compressed", 2).size());
  RawCloud sut;
  store_le<std::uint32_t>(file, body + 4, 0xFFFFFFFF);
  EXPECT_EQ(parse_pcd(file, sut), CloudRefusal::kBadCompression);

  file = Written("FIELDS x\nSIZE 4\nTYPE F\nPOINTS 1000000000\nDATA binary_compressed\n")
             .add_le<std::uint32_t>(4)
             .add_le<std::uint32_t>(4'000'000'000)
             .add("abcd")
             .bytes();
  EXPECT_EQ(parse_pcd(file, sut), CloudRefusal::kBadCompression);
}

template <typename Parse>
void survive_mutations(const std::vector<Bytes>& files, Parse&& parse) {
  std::mt19937 random(3);
  std::size_t refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes file = files[static_cast<std::size_t>(round) % files.size()];
    for (std::size_t i = 0; i <= random() % 4; ++i) {
      file[random() % file.size()] = static_cast<std::byte>(random());
    }
    RawCloud cloud;
    if (parse(file, cloud)) {
      ++refused;
      continue;
    }
    double sum = 0.0;  // reads every value: the sanitizers look on
    for (const Column& column : cloud.columns) {
      for (std::size_t i = 0; i < std::min<std::size_t>(cloud.points, 4); ++i) {
        sum += cloud.number(column, i);
        sum += cloud.number(column, cloud.points - 1 - i);
      }
    }
    ASSERT_TRUE(std::isnan(sum) || sum != 0.5);
  }
  EXPECT_GT(refused, 100U);
}

TEST(Pcd, SurvivesMutations) {
  survive_mutations({binary_pcd(), compressed_pcd(), ascii_pcd()}, parse_pcd);
}

std::string ply_header(const std::string& format) {
  return "ply\r\nformat " + format +
         " 1.0\ncomment made by hand\nelement vertex 2\nproperty float x\nproperty double y\n"
         "property float32 z\nproperty uint64 t\nproperty ushort ring\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n";
}

template <bool kBig>
Bytes binary_ply() {
  Written file(ply_header(kBig ? "binary_big_endian" : "binary_little_endian"));
  const auto put = [&file](auto value) {
    kBig ? file.add_be(value) : file.add_le(value);
  };
  for (int i = 0; i < 2; ++i) {
    put(1.5F + static_cast<float>(i));
    put(-2.0);
    put(0.25F);
    put(kTime + static_cast<std::uint64_t>(i));
    put(std::uint16_t{300});
  }
  return file.bytes();
}

Bytes ascii_ply() {
  return Written(ply_header("ascii"))
      .add("1.5 -2 .25 1700000000123456789 300\n+2.5 -2 0.25 1700000000123456790 300\n3 0 1 1\n")
      .bytes();
}

TEST(Ply, ReadsTheThreeEncodings) {
  for (const Bytes& file : {binary_ply<false>(), binary_ply<true>(), ascii_ply()}) {
    RawCloud sut;

    ASSERT_EQ(parse_ply(file, sut), std::nullopt);

    expect_the_two_points(sut);
  }
}

TEST(Ply, RefusesWhatItDoesNotRead) {
  RawCloud sut;
  const auto parse = [&sut](const std::string& text) {
    return parse_ply(Written(text).bytes(), sut);
  };

  EXPECT_EQ(parse("plyx\n"), CloudRefusal::kBadHeader);
  EXPECT_EQ(parse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"),
            CloudRefusal::kBadHeader);  // no end
  EXPECT_EQ(
      parse("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n"),
      CloudRefusal::kUnsupported);
  EXPECT_EQ(parse("ply\nformat ascii 1.0\nelement camera 1\nproperty int a\nelement vertex 1\n"
                  "property float x\nend_header\n1 1\n"),
            CloudRefusal::kUnsupported);
  EXPECT_EQ(parse("ply\nformat binary_middle_endian 1.0\nelement vertex 0\nproperty float x\n"
                  "end_header\n"),
            CloudRefusal::kUnsupported);
  EXPECT_EQ(parse("ply\nformat binary_little_endian 1.0\nelement vertex 4611686018427387905\n"
                  "property float x\nend_header\nabcd"),
            CloudRefusal::kTruncated);
  EXPECT_EQ(parse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\none\n"),
            CloudRefusal::kBadNumber);
}

TEST(Ply, SurvivesMutations) {
  survive_mutations({binary_ply<false>(), binary_ply<true>(), ascii_ply()}, parse_ply);
}

TEST(Lzf, UnpacksWhatWasPacked) {
  std::mt19937 random(5);
  for (const std::size_t size : {0U, 1U, 2U, 3U, 31U, 32U, 33U, 300U, 9000U, 70'000U}) {
    for (const unsigned alphabet : {1U, 3U, 256U}) {
      Bytes in(size);
      for (std::byte& byte : in) {
        byte = static_cast<std::byte>(random() % alphabet);
      }
      const Bytes packed = lzf_pack(in);
      Bytes out(size);

      ASSERT_TRUE(lzf_unpack(packed, out));

      EXPECT_EQ(out, in);
      Bytes larger(size + 1);
      EXPECT_FALSE(lzf_unpack(packed, larger));
      if (size > 0) {
        Bytes smaller(size - 1);
        EXPECT_FALSE(lzf_unpack(packed, smaller));
      }
    }
  }
}

TEST(Lzf, RefusesReferencesInFrontOfTheBeginning) {
  const auto unpacks = [](std::initializer_list<int> packed) {
    Bytes in;
    for (const int byte : packed) {
      in.push_back(static_cast<std::byte>(byte));
    }
    Bytes out(4);
    return lzf_unpack(in, out);
  };

  EXPECT_TRUE(unpacks({0, 'A', 0x20, 0}));        // one byte, then three times the byte before
  EXPECT_FALSE(unpacks({0, 'A', 0x20, 1}));       // two back, where one is
  EXPECT_FALSE(unpacks({0x40, 0}));               // nothing is there yet
  EXPECT_FALSE(unpacks({0, 'A', 0x20}));          // the distance is missing
  EXPECT_FALSE(unpacks({0, 'A', 0xE0}));          // the length, too
  EXPECT_FALSE(unpacks({3, 'A', 'B', 'C'}));      // a literal is missing
  EXPECT_FALSE(unpacks({0, 'A', 0xE0, 255, 0}));  // runs over the end
}

TEST(Lzf, SurvivesAnyBytes) {
  std::mt19937 random(9);
  Bytes out(500);
  for (int round = 0; round < 20'000; ++round) {
    Bytes packed(random() % 60);
    for (std::byte& byte : packed) {
      byte = static_cast<std::byte>(random() % (round % 2 == 0 ? 256 : 40));
    }
    lzf_unpack(packed, out);
  }
}

TEST(Bin, RefusesAPartOfAPoint) {
  RawCloud sut;
  EXPECT_EQ(parse_bin(Bytes(17), sut), CloudRefusal::kTruncated);
  EXPECT_EQ(parse_bin({}, sut), std::nullopt);
  EXPECT_EQ(sut.points, 0U);
}

}  // namespace
}  // namespace slamd::clouds
