#include "client/submap_table.hpp"

#include <gtest/gtest.h>

namespace slamd::client {
namespace {

/// A chunk of a table of two submaps.
bus::SubmapPoses chunk(int second, std::uint16_t index, std::uint32_t epoch = 1) {
  bus::SubmapPoses chunk;
  chunk.stamp = Stamp{} + std::chrono::seconds(second);
  chunk.epoch = epoch;
  chunk.index = index;
  chunk.count = 2;
  chunk.size = 1;
  chunk.submaps[0].id = 7U - index;
  chunk.submaps[0].version = static_cast<std::uint32_t>(second);
  return chunk;
}

TEST(SubmapTable, IsNewWhenAllChunksHaveComeInAnyOrder) {
  SubmapTable sut;

  EXPECT_FALSE(sut.add(chunk(1, 0)));
  EXPECT_FALSE(sut.add(chunk(1, 0))) << "twice";
  EXPECT_TRUE(sut.places().empty());
  EXPECT_TRUE(sut.add(chunk(1, 1)));
  ASSERT_EQ(sut.places().size(), 2U);
  EXPECT_EQ(sut.places()[0].id, 6) << "by id";
  EXPECT_EQ(sut.places()[1].id, 7);
  EXPECT_EQ(sut.epoch(), 1U);
}

TEST(SubmapTable, KeepsTheOldOneWhileChunksAreLost) {
  SubmapTable sut;
  sut.add(chunk(1, 0));
  sut.add(chunk(1, 1));

  EXPECT_FALSE(sut.add(chunk(2, 0)));
  EXPECT_FALSE(sut.add(chunk(3, 1))) << "of another table";
  EXPECT_FALSE(sut.add(chunk(2, 1))) << "late";
  EXPECT_EQ(sut.places()[0].version, 1U);
  EXPECT_TRUE(sut.add(chunk(3, 0)));
  EXPECT_EQ(sut.places()[0].version, 3U);
}

TEST(SubmapTable, TakesAnotherEpochWhateverItsStamp) {
  SubmapTable sut;
  sut.add(chunk(5, 0));
  sut.add(chunk(5, 1));

  EXPECT_FALSE(sut.add(chunk(2, 0, 2)));
  EXPECT_EQ(sut.epoch(), 1U);
  EXPECT_TRUE(sut.add(chunk(2, 1, 2)));
  EXPECT_EQ(sut.epoch(), 2U);
  EXPECT_EQ(sut.places()[0].version, 2U);
}

}  // namespace
}  // namespace slamd::client
