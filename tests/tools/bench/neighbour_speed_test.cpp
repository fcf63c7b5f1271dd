#include "tools/bench/neighbour_speed.hpp"

#include <gtest/gtest.h>

namespace slamd::bench {
namespace {

TEST(NeighbourSpeed, MissesNoNeighbourInAnyStructure) {
  const NeighbourCase sut{"small", 3'000, 400, 0.4F, 0.2F};

  const NeighbourTable table = measure_neighbours(sut, 1, 2, [](double) {});

  EXPECT_GE(table.stored_points, sut.stored_points);
  ASSERT_GE(table.structures.size(), 1U);
  for (const NeighbourSpeed& speed : table.structures) {
    EXPECT_EQ(speed.recall, 1.0) << speed.name;
    EXPECT_GT(speed.query_us, 0.0) << speed.name;
  }
  EXPECT_NE(text_of(table).find("slamd"), std::string::npos);
}

}  // namespace
}  // namespace slamd::bench
