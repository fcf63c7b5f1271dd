#include "core/occupancy/map_delta.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace slamd::occupancy {
namespace {

MapDelta empty_message() {
  MapDelta message;
  message.map_id = 1;
  message.covers = {100, 200};
  message.newest = 300;
  message.window = {{-5, 3, -2}, {10, 12, 4}};
  return message;
}

BlockStates random_states(std::mt19937_64& engine) {
  BlockStates states;
  const unsigned kind = engine() % 5;
  for (int place = 0; place < kBlockCells; ++place) {
    const auto any = static_cast<CellState>(engine() % 3);
    states.set(place, kind < 3 ? static_cast<CellState>(kind) : kind == 3 ? any : static_cast<CellState>(place / 100 % 3));
  }
  return states;
}

TEST(MapDelta, TellsItsBlocksAsTheyWere) {
  std::mt19937_64 engine(7);
  for (int run = 0; run < 200; ++run) {
    MapDelta message = empty_message();
    BlockWriter writer(message);
    std::vector<SentBlock> sent;
    for (std::uint64_t number = 100; sent.size() < 30;) {
      number += 1 + engine() % 3;
      const SentBlock block{number, message.window.block_of_place(static_cast<std::int32_t>(engine() % message.window.blocks())), random_states(engine)};
      if (!writer.add(block)) {
        break;
      }
      sent.push_back(block);
    }

    ASSERT_TRUE(is_well_formed(message));
    ASSERT_EQ(message.blocks, sent.size());
    BlockReader sut(message);
    for (const SentBlock& expected : sent) {
      const auto block = sut.next();
      ASSERT_TRUE(block);
      ASSERT_EQ(block->number, expected.number);
      ASSERT_EQ(block->index, expected.index);
      ASSERT_EQ(block->states, expected.states);
    }
    ASSERT_FALSE(sut.next());
  }
}

TEST(MapDelta, HoldsABlockOfOneStateInThreeBytesAndAnyInFewMoreThanItsPlanes) {
  std::mt19937_64 engine(8);
  MapDelta message = empty_message();
  BlockWriter writer(message);
  BlockStates states;
  states.free.fill(~std::uint64_t{0});
  ASSERT_TRUE(writer.add({101, message.window.block_of_place(1), states}));
  EXPECT_EQ(message.payload.size(), 3U);
  for (int place = 0; place < kBlockCells; ++place) {
    states.set(place, static_cast<CellState>(engine() % 3));
  }

  ASSERT_TRUE(writer.add({102, message.window.block_of_place(2), states}));

  EXPECT_EQ(message.payload.size(), 3U + 3U + 128U);
}

TEST(MapDelta, IsRefusedWhenMalformed) {
  std::mt19937_64 engine(9);
  MapDelta good = empty_message();
  BlockWriter writer(good);
  for (std::uint64_t i = 1; i < 6; ++i) {
    ASSERT_TRUE(writer.add({100 + i, good.window.block_of_place(static_cast<std::int32_t>(50 * i)), random_states(engine)}));
  }
  ASSERT_TRUE(is_well_formed(good));
  const auto refuses = [&](auto&& spoil) {
    MapDelta message = good;
    spoil(message);
    return !is_well_formed(message);
  };

  EXPECT_TRUE(refuses([](MapDelta& m) { m.cell_m = 0.0; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.cell_m = std::numeric_limits<double>::quiet_NaN(); }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.window.size = {1 << 10, 1 << 10, 1 << 10}; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.window.size[1] = 0; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.window.size = {2, 2, 2}; })) << "its blocks lie outside";
  EXPECT_TRUE(refuses([](MapDelta& m) { m.window.first.x = 1 << 28; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.window.first.y = std::numeric_limits<std::int32_t>::min(); }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.anchor.z = std::numeric_limits<std::int32_t>::min(); }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.covers = {200, 100}; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.covers.to = 104; })) << "a block changed after";
  EXPECT_TRUE(refuses([](MapDelta& m) { m.newest = 150; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.blocks = 4; }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.payload.resize(m.payload.size() - 1); }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.payload.push_back(std::byte{0}); }));
  EXPECT_TRUE(refuses([](MapDelta& m) { m.submap = -2; }));
}

}  // namespace
}  // namespace slamd::occupancy
