#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/mapping/cloud_builder.hpp"
#include "core/mapping/cloud_pool.hpp"

namespace slamd::mapping {
namespace {

std::vector<Eigen::Vector3f> scattered(std::size_t count, float reach_m) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> place(-reach_m, reach_m);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(place(engine), place(engine), place(engine));
  }
  return points;
}

std::vector<Eigen::Vector3f> points_of(const CloudPool& pool, CloudSlot slot) {
  std::vector<Eigen::Vector3f> points;
  pool.for_each_point(slot, [&](const Eigen::Vector3f& p) { points.push_back(p); });
  return points;
}

TEST(CloudPool, GivesPointsBackToHalfAStep) {
  CloudPool sut(2, 1000);
  const auto points = scattered(700, 100.0F);

  const CloudSlot slot = sut.store(points);

  const auto back = points_of(sut, slot);
  ASSERT_EQ(back.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((back[i] - points[i]).cwiseAbs().maxCoeff(), 0.51F * CloudPool::kStep_m);
  }
}

TEST(CloudPool, LeavesOutWhatIsOutOfReachOrNoNumber) {
  CloudPool sut(1, 10);
  const std::vector<Eigen::Vector3f> points = {{1.0F, 0.0F, 0.0F}, {170.0F, 0.0F, 0.0F}, {NAN, 0.0F, 0.0F}, {0.0F, -163.0F, 2.0F}};

  const CloudSlot slot = sut.store(points);

  EXPECT_EQ(sut.points(slot), 2U);
}

TEST(CloudPool, SaysWhenNoSlotIsFreeAndGoesOnWhenOneIs) {
  CloudPool sut(2, 10);
  const auto points = scattered(5, 1.0F);
  const CloudSlot first = sut.store(points);
  sut.store(points);

  EXPECT_EQ(sut.store(points), kNoCloud);
  sut.release(first);
  EXPECT_EQ(sut.store(points), first);
}

TEST(CloudBuilder, ThinsToWhatIsWantedAndKeepsTheSpread) {
  CloudBuilder sut(20'000);
  sut.begin(0.1F);
  sut.add(scattered(10'000, 10.0F), geometry::Se3());

  const auto cloud = sut.thinned(1'000);

  EXPECT_LE(cloud.size(), 1'000U);
  EXPECT_GT(cloud.size(), 400U);
  for (int octant = 0; octant < 8; ++octant) {
    const auto in_it = std::count_if(cloud.begin(), cloud.end(), [&](const Eigen::Vector3f& p) {
      return (p.x() > 0) == ((octant & 1) != 0) && (p.y() > 0) == ((octant & 2) != 0) && (p.z() > 0) == ((octant & 4) != 0);
    });
    EXPECT_GT(in_it, static_cast<std::ptrdiff_t>(cloud.size() / 16));
  }
}

TEST(CloudBuilder, TakesEachCubeOnceWhateverTheScan) {
  CloudBuilder sut(20'000);
  sut.begin(0.5F);
  const auto points = scattered(2'000, 5.0F);
  sut.add(points, geometry::Se3());
  const std::size_t before = sut.size();

  sut.add(points, geometry::Se3());

  EXPECT_EQ(sut.size(), before);
}

}  // namespace
}  // namespace slamd::mapping
