#include "tools/sensors/can_watch.hpp"

#include <gtest/gtest.h>

#include "tests/hex/hex.hpp"

namespace slamd::sensors {
namespace {

transport::CanFrame frame_of(std::uint32_t id, std::string_view data, bool is_extended = false) {
  transport::CanFrame frame;
  frame.id = id;
  frame.is_extended = is_extended;
  for (const std::byte byte : hex::from_hex(data)) {
    frame.data[frame.size++] = byte;
  }
  return frame;
}

TEST(CanWatch, CountsFramesByTheirIds) {
  CanWatch sut;

  sut.take(frame_of(0x1A0, "00010002"));
  sut.take(frame_of(0x1A0, "0001000200"));
  sut.take(frame_of(0x1A0, "01", true));
  sut.end_second();
  sut.take(frame_of(0x7FF, ""));

  const BusSeen seen = sut.seen();
  ASSERT_EQ(seen.ids.size(), 3U);
  EXPECT_EQ(seen.frames, (Count{4, 3}));
  EXPECT_EQ(seen.ids[0].id, 0x1A0U);
  EXPECT_EQ(seen.ids[0].size, 5U);  // of the last
  EXPECT_EQ(seen.ids[0].frames, (Count{2, 2}));
  EXPECT_EQ(seen.ids[1].frames, (Count{1, 0}));
  EXPECT_TRUE(seen.ids[2].is_extended);
}

TEST(CanWatch, KeepsAccountOfSoManyIdsAndCountsTheRest) {
  CanWatch sut;

  for (std::uint32_t id = 0; id < 1000; ++id) {
    sut.take(frame_of(id, "00", true));
  }

  EXPECT_EQ(sut.seen().ids.size(), CanWatch::kMostIds);
  EXPECT_EQ(sut.seen().ids_left_out, 1000U - CanWatch::kMostIds);
}

TEST(CanWatch, KnowsAnXsensByItsGoldenFrames) {
  CanWatch sut;

  for (const auto& [id, data] : {std::pair(0x005U, "0314ED53"), std::pair(0x032U, "0005FFF60100"), std::pair(0x034U, "000DFFE109CF")}) {
    sut.take(frame_of(id, data));
  }
  sut.end_second();

  EXPECT_EQ(sut.seen().xsens.samples, (Count{1, 1}));
  EXPECT_EQ(sut.seen().aceinna.samples.total, 0U);
  EXPECT_NEAR(sut.seen().xsens.mean_force_mps2.z(), 9.81, 0.01);
}

}  // namespace
}  // namespace slamd::sensors
