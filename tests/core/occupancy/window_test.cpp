#include "core/occupancy/window.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/occupancy/state_map.hpp"

namespace slamd::occupancy {
namespace {

TEST(Window, GivesEachOfItsBlocksASlotOfItsOwn) {
  std::mt19937_64 engine(1);
  for (int run = 0; run < 50; ++run) {
    const auto any = [&engine](int n) { return static_cast<std::int32_t>(engine() % static_cast<unsigned>(n)); };
    const Window sut{{any(100) - 50, any(100) - 50, any(100) - 50}, {1 + any(7), 1 + any(7), 1 + any(4)}};
    std::set<std::size_t> slots;
    for (std::int32_t place = 0; place < static_cast<std::int32_t>(sut.blocks()); ++place) {
      const BlockIndex block = sut.block_of_place(place);
      ASSERT_TRUE(sut.contains(block));
      ASSERT_EQ(sut.place_of(block), place);
      ASSERT_EQ(sut.block_at(sut.slot_of(block)), block);
      slots.insert(sut.slot_of(block));
    }
    EXPECT_EQ(slots.size(), sut.blocks());
  }
}

TEST(StateMap, KeepsWhatStaysInTheWindowAndForgetsTheRest) {
  StateMap sut(Window{{0, 0, 0}, {4, 4, 2}}, 0.2);
  sut.block(sut.window().slot_of({1, 2, 0})).set(5, CellState::kOccupied);
  sut.block(sut.window().slot_of({0, 2, 0})).set(5, CellState::kOccupied);
  int entered = 0;

  sut.move_to({1, 0, 0}, [&](std::size_t, const BlockIndex& old) { entered += old.x == 0 ? 1 : 100; });

  EXPECT_EQ(entered, 8) << "a face of blocks";
  EXPECT_EQ(sut.at({13, 16, 0}), CellState::kOccupied);
  EXPECT_EQ(sut.at({5, 16, 0}), CellState::kUnknown);
  sut.move_to({0, 0, 0}, [](std::size_t, const BlockIndex&) {});
  EXPECT_EQ(sut.at({5, 16, 0}), CellState::kUnknown) << "it does not come back";
}

TEST(CellIndex, OfNegativePlacesIsBelowThem) {
  const CellIndex cell = cell_of({-0.01, -1.61, 0.0}, 0.2);

  EXPECT_EQ(cell, (CellIndex{-1, -9, 0}));
  EXPECT_EQ(cell.block(), (BlockIndex{-1, -2, 0}));
  EXPECT_EQ(cell.place(), 7 + 8 * 7);
}

}  // namespace
}  // namespace slamd::occupancy
