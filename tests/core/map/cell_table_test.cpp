#include "core/map/cell_table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <list>
#include <map>

namespace slamd::map {
namespace {

struct Cell {
  void clear() { value = 0; }

  int value = 0;
};

/// What the table promises, in the simplest form: a list ordered by the last touch.
class Model {
 public:
  explicit Model(std::size_t capacity) : capacity_(capacity) {}

  int& touch(CellKey key, float path_m) {
    for (auto it = cells_.begin(); it != cells_.end(); ++it) {
      if (it->key == key) {
        cells_.splice(cells_.end(), cells_, it);
        cells_.back().path_m = path_m;
        return cells_.back().value;
      }
    }
    if (cells_.size() == capacity_) {
      cells_.pop_front();
    }
    cells_.push_back({key, path_m, 0});
    return cells_.back().value;
  }

  void forget_before(float path_m) {
    while (!cells_.empty() && cells_.front().path_m < path_m) {
      cells_.pop_front();
    }
  }

  struct Entry {
    CellKey key;
    float path_m;
    int value;
  };
  std::list<Entry> cells_;

 private:
  std::size_t capacity_;
};

TEST(CellTable, BehavesLikeAListOrderedByTouch) {
  EXPECT_TRUE(rc::check("any sequence of touches and forgetting", [] {
    const auto capacity = *rc::gen::inRange<std::size_t>(1, 12);
    const auto keys = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 25));
    CellTable<Cell> sut(capacity);
    Model model(capacity);
    float path_m = 0.0F;
    for (const int key : keys) {
      path_m += 1.0F;
      if (key == 0) {
        sut.forget_before(path_m - 5.0F);
        model.forget_before(path_m - 5.0F);
        continue;
      }
      // Keys that are multiples of a power of two collide in small tables.
      const CellKey spread = static_cast<CellKey>(key) << 24;
      sut.touch(spread, path_m).value += key;
      model.touch(spread, path_m) += key;
    }
    RC_ASSERT(sut.size() == model.cells_.size());
    auto expected = model.cells_.begin();
    sut.for_each([&](CellKey key, const Cell& cell) {
      RC_ASSERT(key == expected->key);
      RC_ASSERT(cell.value == expected->value);
      ++expected;
    });
    for (int key = 1; key < 25; ++key) {
      const CellKey spread = static_cast<CellKey>(key) << 24;
      const bool known = std::any_of(model.cells_.begin(), model.cells_.end(),
                                     [&](const Model::Entry& entry) { return entry.key == spread; });
      RC_ASSERT((sut.find(spread) != nullptr) == known);
    }
  }));
}

}  // namespace
}  // namespace slamd::map
