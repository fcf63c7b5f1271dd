#include "tools/simulate/localisability.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamd::simulate {
namespace {

TEST(TrueLocalisability, IsNearlyNothingAlongTheMiddleOfATunnel) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kLivoxAvia}) {
    const Scene scene({.lidar = lidar, .duration_s = 60.0, .world = "tunnel"});

    const TrueLocalisability sut = true_localisability(scene, 40.0);

    const Eigen::Vector3d ahead = scene.motion().pose_at(40.0).rotation().col(0);
    EXPECT_GT(sut.beams, 700);
    EXPECT_LT(sut.share, 0.01);
    EXPECT_GT(sut.second, 0.05);
    EXPECT_GT(std::abs(sut.weakest.dot(ahead)), 0.99);
  }
}

TEST(TrueLocalisability, IsAmpleInATown) {
  const Scene scene({.duration_s = 30.0, .world = "town"});

  EXPECT_GT(true_localisability(scene, 10.0).share, 0.03);
}

}  // namespace
}  // namespace slamd::simulate
