#include "tools/loopnet/place_visit.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamd::loopnet {
namespace {

const Eigen::Vector2d kTower(50.0, 30.0);

/// A plain with one tower, east of the lane.
PlaceWorld plain() {
  const auto flat = [](double, double) { return 0.0; };
  PlaceWorld world{{flat, {60.0, 60.0}, 1, {}, 10.0}, {{{20.0, 30.0}, {30.0, 30.0}}}, flat, false};
  world.world.add(simulate::OrientedBox{{kTower.x(), kTower.y(), 5.0}, {1.0, 1.0, 5.0}, 0.0, 0.6F});
  world.world.build();
  return world;
}

/// Where the cells above base have their points. Units: rad, in level.
double bearing_of(const loop::PolarImage& image) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t row = 4 * loop::PolarImage::kRings; row < loop::PolarImage::kSlices * loop::PolarImage::kRings; ++row) {
    for (std::size_t azimuth = 0; azimuth < loop::PolarImage::kAzimuths; ++azimuth) {
      const double turn = 2.0 * M_PI * (static_cast<double>(azimuth) + 0.5) / loop::PolarImage::kAzimuths;
      sum += image.cells[row * loop::PolarImage::kAzimuths + azimuth] * Eigen::Vector2d(std::cos(turn), std::sin(turn));
    }
  }
  return std::atan2(sum.y(), sum.x());
}

TEST(Visitor, VisitsEachPlaceAsOftenAsAskedAndNotFarFromIt) {
  const PlaceWorld world = plain();
  Visitor sut(world, {PlaceSensor::Kind::kVlp16, SubmapKind::kSingle}, 3);

  const std::vector<Visit> visits = sut.visit(4, 3);

  ASSERT_EQ(visits.size(), 12U);
  for (std::size_t i = 0; i < visits.size(); ++i) {
    EXPECT_EQ(visits[i].place, i / 3);
    const Eigen::Vector3d apart = visits[i].T_world_level.translation() - visits[i / 3 * 3].T_world_level.translation();
    EXPECT_LT(apart.norm(), 8.8);
  }
}

TEST(Visitor, ShowsThingsWhereTheHeadingHasThem) {
  const PlaceWorld world = plain();
  for (const SubmapKind submaps : {SubmapKind::kSingle, SubmapKind::kAny, SubmapKind::kMapped}) {
    Visitor sut(world, {PlaceSensor::Kind::kVlp16, submaps}, 4);

    for (const Visit& visit : sut.visit(4, 3)) {
      const Eigen::Vector2d to_tower = kTower - visit.T_world_level.translation().head<2>();
      const double expected_rad = std::atan2(to_tower.y(), to_tower.x()) - visit.heading_rad;
      EXPECT_NEAR(std::remainder(bearing_of(visit.image) - expected_rad, 2.0 * M_PI), 0.0, 0.06);
    }
  }
}

TEST(Visitor, MakesTheSameVisitsOfTheSameSeed) {
  const PlaceWorld world = plain();
  const VisitorSettings settings{PlaceSensor::Kind::kVlp16, SubmapKind::kMapped};

  const std::vector<Visit> first = Visitor(world, settings, 6).visit(1, 2);
  const std::vector<Visit> again = Visitor(world, settings, 6).visit(1, 2);

  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[1].image.cells, again[1].image.cells);
  EXPECT_NE(first[0].image.cells, first[1].image.cells);
}

TEST(MakePlaceWorld, KnowsItsNamesAndRefusesOthers) {
  EXPECT_FALSE(make_place_world("floors", 1).lanes.empty());
  EXPECT_THROW(make_place_world("moon", 1), std::invalid_argument);
}

}  // namespace
}  // namespace slamd::loopnet
