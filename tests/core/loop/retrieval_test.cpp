#include "core/loop/retrieval.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/support/allocation_guard.hpp"

namespace slamd::loop {
namespace {

/// A place of walls at random ranges, the same for the same seed; `turn` azimuths of 3° to the left.
PolarImage place(unsigned seed, std::size_t turn = 0) {
  std::mt19937 random(seed);
  PolarImage image;
  for (std::size_t sector = 0; sector < 24; ++sector) {
    const std::size_t ring = 8 + random() % 28;
    const std::size_t top = 1 + random() % 7;
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t slice = 0; slice < top; ++slice) {
        image.cells[PolarImage::index(slice, ring, (5 * sector + i + turn) % PolarImage::kAzimuths)] = 90;
      }
    }
  }
  return image;
}

class RetrievalTest : public ::testing::Test {
 protected:
  Descriptor describe(const PolarImage& image) {
    Descriptor descriptor;
    net_.describe(image, descriptor);
    return descriptor;
  }

  void add_places(Retrieval& sut, unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      ASSERT_TRUE(sut.add(i, describe(place(i))));
    }
  }

  /// Takes all comparisons as overlaps: these tests are about the bank, not about the network.
  static RetrievalConfig config() {
    RetrievalConfig config;
    config.capacity = 40;
    config.least_overlap_logit = -std::numeric_limits<float>::infinity();
    return config;
  }

  LoopNet net_;
};

TEST_F(RetrievalTest, FindsThePlaceAndTheYawOfTheQueryInIt) {
  Retrieval sut(config());
  add_places(sut, 40);

  const std::span<const Candidate> candidates = sut.search(net_, describe(place(17, 30)), 40);

  ASSERT_EQ(candidates.size(), 3U);
  EXPECT_EQ(candidates[0].keyframe, 17U);
  // What stands at φ in the keyframe stands at φ + 90° in the query: the query looks 90° to the right of the keyframe.
  EXPECT_NEAR(candidates[0].yaw_rad, -M_PI_2, 0.01);
  EXPECT_GE(candidates[0].overlap_logit, candidates[1].overlap_logit);
}

TEST_F(RetrievalTest, LeavesRecentKeyframesOut) {
  Retrieval sut(config());
  add_places(sut, 40);

  for (const Candidate& candidate : sut.search(net_, describe(place(17)), 17)) {
    EXPECT_LT(candidate.keyframe, 17U);
  }
  EXPECT_TRUE(sut.search(net_, describe(place(17)), 0).empty());
}

TEST_F(RetrievalTest, LeavesOutWhatIsNoOverlap) {
  RetrievalConfig strict = config();
  strict.least_overlap_logit = std::numeric_limits<float>::infinity();
  Retrieval sut(strict);
  add_places(sut, 5);

  EXPECT_TRUE(sut.search(net_, describe(place(3)), 5).empty());
}

TEST_F(RetrievalTest, ForgetsAndRemembersAgain) {
  Retrieval sut(config());
  add_places(sut, 40);
  EXPECT_FALSE(sut.add(40, describe(place(40))));
  sut.remove(17);
  sut.remove(17);
  EXPECT_EQ(sut.size(), 39U);
  EXPECT_EQ(sut.find(17), nullptr);
  EXPECT_NE(sut.search(net_, describe(place(17)), 40)[0].keyframe, 17U);
  EXPECT_EQ(sut.search(net_, describe(place(39)), 40)[0].keyframe, 39U);  // the one that took its room

  EXPECT_TRUE(sut.add(41, describe(place(17))));

  EXPECT_EQ(sut.search(net_, describe(place(17)), 50)[0].keyframe, 41U);
}

TEST_F(RetrievalTest, ShortlistIsThatOfASortOfAll) {
  RetrievalConfig all = config();
  all.shortlist = 7;
  all.best = 7;
  Retrieval sut(all);
  add_places(sut, 40);
  const Descriptor query = describe(place(99));
  std::vector<std::pair<float, KeyframeNumber>> order;
  for (KeyframeNumber i = 0; i < 40; ++i) {
    order.emplace_back(-similarity(query, *sut.find(i)), i);
  }
  std::sort(order.begin(), order.end());
  std::vector<KeyframeNumber> expected;
  for (std::size_t i = 0; i < 7; ++i) {
    expected.push_back(order[i].second);
  }
  std::sort(expected.begin(), expected.end());

  std::vector<KeyframeNumber> found;
  for (const Candidate& candidate : sut.search(net_, query, 40)) {
    found.push_back(candidate.keyframe);
  }
  std::sort(found.begin(), found.end());

  EXPECT_EQ(found, expected);
}

TEST_F(RetrievalTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Retrieval sut(config());
  const Descriptor query = describe(place(3));

  EXPECT_EQ(support::count_allocations([&] {
              sut.add(1, query);
              sut.add(2, query);
              sut.search(net_, query, 5);
              sut.remove(1);
            }),
            0U);
}

}  // namespace
}  // namespace slamd::loop
