#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "tests/scratch/scratch_folder.hpp"
#include "tools/map/navigation_grid.hpp"
#include "tools/map/reoptimise.hpp"
#include "tools/map/session_cloud.hpp"
#include "tools/map/session_info.hpp"

namespace slamd::map {
namespace {

using geometry::Se3;
using Cell = NavigationGrid::Cell;

constexpr std::size_t kSides = 40;

/// Twice around a circle of 10 m radius whose odometry bends: odom ends away from where map is.
struct Round {
  storage::Session session;
  std::vector<Se3> truth;
};

Se3 step_by(double bend_rad) {
  const double angle = 2.0 * std::numbers::pi / kSides + bend_rad;
  return {Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(), Eigen::Vector3d(10.0 * 2.0 * std::numbers::pi / kSides, 0.0, 0.0)};
}

Round made_round(double bend_rad) {
  Round round;
  Se3 T_odom_base;
  Se3 T_world_base;
  for (graph::KeyframeId id = 0; id < 2 * kSides; ++id) {
    storage::SessionKeyframe keyframe;
    keyframe.id = id;
    keyframe.stamp = Stamp(std::chrono::seconds(id));
    keyframe.T_odom_base = T_odom_base;
    keyframe.path_m = 1.5 * id;
    keyframe.odometry.information = geometry::Matrix6d::Identity() / 1e-4;
    keyframe.cloud_level = {{2.0F, 0.0F, 0.5F}, {2.0F, 0.0F, 0.5F}, {0.0F, 3.0F, 0.0F}};
    round.session.keyframes.push_back(keyframe);
    round.session.T_map_base.push_back(T_odom_base);
    round.truth.push_back(T_world_base);
    T_odom_base = T_odom_base * step_by(bend_rad);
    T_world_base = T_world_base * step_by(0.0);
  }
  return round;
}

storage::SessionLoop loop_of(graph::LoopId id, graph::KeyframeId a, graph::KeyframeId b, const Se3& T_a_b) {
  return {id, a, b, {T_a_b, geometry::Matrix6d::Identity() / 1e-4}, false};
}

TEST(SessionCloud, LiesInMapAndIsThinned) {
  Round round = made_round(0.0);
  round.session.keyframes.resize(1);
  round.session.T_map_base = {Se3(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {5.0, 0.0, 0.0})};

  const auto all = cloud_of(round.session, 0.0F);
  const auto thinned = cloud_of(round.session, 0.1F);

  ASSERT_EQ(all.size(), 3U);
  EXPECT_LT((all[0] - Eigen::Vector3f(5.0F, 2.0F, 0.5F)).norm(), 1e-5F);
  EXPECT_EQ(thinned.size(), 2U);
}

TEST(Reoptimise, ClosesARoundByItsLoopsAndTakesAWrongOneOut) {
  Round round = made_round(0.002);
  for (graph::LoopId id = 0; id < 10; ++id) {
    const graph::KeyframeId a = 4 * id;
    const graph::KeyframeId b = a + kSides;
    round.session.loops.push_back(loop_of(id, a, b, round.truth[a].inverse() * round.truth[b]));
  }
  round.session.loops.push_back(loop_of(90, 3, 60, Se3(Eigen::Matrix3d::Identity(), {0.0, 6.0, 0.0})));
  round.session.loops.back().accepted = true;
  const double before_m = (round.session.T_map_base.back().translation() - round.truth.back().translation()).norm();

  const Reoptimised result = reoptimise(round.session);

  const double after_m = (round.session.T_map_base.back().translation() - round.truth.back().translation()).norm();
  EXPECT_EQ(result.accepted, 10U);
  EXPECT_EQ(result.taken_in, 10U);
  EXPECT_EQ(result.taken_out, 1U);
  EXPECT_GT(result.largest_move_m, 0.1);
  EXPECT_GT(before_m, 0.5);
  EXPECT_LT(after_m, 0.3 * before_m);
}

TEST(NavigationGridTest, HasWallsWhereBeamsEndAndFreeGroundWhereTheyGoThrough) {
  storage::Session session;
  storage::SessionKeyframe keyframe;
  for (int i = -20; i <= 20; ++i) {
    keyframe.cloud_level.emplace_back(5.0F, 0.1F * static_cast<float>(i), 0.8F);   // a wall ahead
    keyframe.cloud_level.emplace_back(-4.0F, 0.1F * static_cast<float>(i), -0.3F);  // ground behind
    keyframe.cloud_level.emplace_back(0.1F * static_cast<float>(i), 3.0F, 2.5F);   // what is driven under
  }
  session.keyframes = {keyframe};
  session.T_map_base = {Se3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(100.0, 50.0, 0.0))};

  const NavigationGrid sut = grid_of(session, {.resolution_m = 0.1, .lowest_m = 0.25, .highest_m = 1.8, .ground_m = -0.3, .reach_m = 30.0});

  EXPECT_EQ(sut.at(105.0, 50.0), Cell::kOccupied);
  EXPECT_EQ(sut.at(105.0, 51.5), Cell::kOccupied);
  EXPECT_EQ(sut.at(103.0, 50.0), Cell::kFree);
  EXPECT_EQ(sut.at(96.0, 50.0), Cell::kFree);
  EXPECT_EQ(sut.at(97.0, 50.5), Cell::kFree);
  EXPECT_EQ(sut.at(100.0, 52.9), Cell::kUnknown);
  EXPECT_EQ(sut.at(105.3, 50.0), Cell::kUnknown) << "behind the wall";
  EXPECT_EQ(sut.at(300.0, 50.0), Cell::kUnknown) << "outside";
}

TEST(NavigationGridTest, ForgetsWhatHasGone) {
  storage::Session session;
  storage::SessionKeyframe with_car;
  with_car.cloud_level = {{4.04F, 0.04F, 0.8F}};
  storage::SessionKeyframe without;
  without.cloud_level.assign(10, Eigen::Vector3f(8.04F, 0.04F, 0.8F));
  session.keyframes = {with_car, without};
  session.T_map_base = {Se3(), Se3()};

  const NavigationGrid sut = grid_of(session, {.resolution_m = 0.1});

  EXPECT_EQ(sut.at(4.04, 0.04), Cell::kFree);
  EXPECT_EQ(sut.at(8.04, 0.04), Cell::kOccupied);
}

class MapFiles : public scratch::ScratchFolder {};

TEST_F(MapFiles, HoldTheGridAsNavigationStacksReadIt) {
  NavigationGrid grid;
  grid.width = 3;
  grid.height = 2;
  grid.resolution_m = 0.05;
  grid.x_m = -1.0;
  grid.y_m = 2.5;
  grid.cells = {Cell::kFree, Cell::kUnknown, Cell::kOccupied, Cell::kUnknown, Cell::kUnknown, Cell::kUnknown};

  write_grid(grid, folder_ / "floor");

  const std::string expected = std::string("P5\n3 2\n255\n") + "\xCD\xCD\xCD" + "\xFE\xCD" + std::string(1, '\0');
  EXPECT_EQ(text_of(folder_ / "floor.pgm"), expected);
  EXPECT_EQ(text_of(folder_ / "floor.yaml"),
            "image: floor.pgm\nresolution: 0.05\norigin: [-1.000000, 2.500000, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
}

TEST(SessionInfo, TellsWhatIsThereAndWhatIsWrong) {
  Round round = made_round(0.0);
  round.session.loops = {loop_of(1, 0, 40, Se3())};
  round.session.begin.sensor = "vlp16";
  round.session.damage = {{"000003.slamd", 120, 7, "cut off"}};
  round.session.lost_records = 4;

  const std::string text = info_text(round.session);
  const auto json = nlohmann::json::parse(info_json(round.session));

  EXPECT_NE(text.find("way          118.5 m in 79.0 s"), std::string::npos) << text;
  EXPECT_NE(text.find("loops        0 accepted, 1 not"), std::string::npos) << text;
  EXPECT_NE(text.find("not closed"), std::string::npos) << text;
  EXPECT_NE(text.find("damaged      000003.slamd from byte 120, 7 bytes: cut off"), std::string::npos) << text;
  EXPECT_EQ(json["keyframes"], 80);
  EXPECT_EQ(json["lost_records"], 4);
  EXPECT_EQ(json["damage"][0]["what"], "cut off");
}

}  // namespace
}  // namespace slamd::map
