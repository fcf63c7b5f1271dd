#include "core/map/surface_cell.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace slamd::map {
namespace {

TEST(SurfaceCell, FindsThePlaneOfNoisyPoints) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<float> uniform(-0.25F, 0.25F);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  const Eigen::Vector3f normal = Eigen::Vector3f(0.2F, -0.5F, 1.0F).normalized();
  const Eigen::Vector3f u = normal.unitOrthogonal();
  const Eigen::Vector3f centre(100.0F, -40.0F, 3.0F);
  SurfaceCell sut;
  for (int i = 0; i < 60; ++i) {
    sut.add(centre + uniform(engine) * u + uniform(engine) * normal.cross(u) + noise(engine) * normal);
  }

  EXPECT_EQ(sut.surface, Surface::kPlane);
  EXPECT_GT(std::abs(sut.axis_odom.dot(normal)), 0.995F);
  EXPECT_NEAR(sut.distance_m(centre + 0.1F * normal), 0.1F, 0.01F);
}

TEST(SurfaceCell, FindsTheLineOfAPole) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<float> uniform(-0.25F, 0.25F);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  SurfaceCell sut;
  for (int i = 0; i < 60; ++i) {
    sut.add({5.0F + noise(engine), 2.0F + noise(engine), uniform(engine)});
  }

  EXPECT_EQ(sut.surface, Surface::kLine);
  EXPECT_GT(std::abs(sut.axis_odom.z()), 0.99F);
  EXPECT_NEAR(sut.distance_m({5.2F, 2.0F, 0.1F}), 0.2F, 0.02F);
}

TEST(SurfaceCell, TakesALevelLineForARingOnAFloorOrAWall) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<float> uniform(-0.25F, 0.25F);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  SurfaceCell sut;
  for (int i = 0; i < 60; ++i) {
    sut.add({uniform(engine), 2.0F + noise(engine), 1.0F + noise(engine)});
  }

  EXPECT_EQ(sut.surface, Surface::kRing);
  EXPECT_NEAR(sut.distance_m({0.1F, 2.2F, 1.0F}), 0.0F, 0.02F);  // farther on the same floor
  EXPECT_NEAR(sut.distance_m({0.1F, 2.0F, 1.2F}), 0.0F, 0.02F);  // higher on the same wall
  EXPECT_NEAR(sut.distance_m({0.1F, 2.2F, 1.1F}), 0.1F, 0.02F);
  EXPECT_GT(std::abs(sut.normal_near({0.1F, 2.2F, 1.1F}).z()), 0.98F);
  EXPECT_GT(std::abs(sut.normal_near({0.1F, 2.1F, 1.2F}).y()), 0.98F);
}

TEST(SurfaceCell, CallsABlobAndAFewPointsUnknown) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<float> uniform(-0.25F, 0.25F);
  SurfaceCell blob;
  SurfaceCell few;
  for (int i = 0; i < 100; ++i) {
    blob.add({uniform(engine), uniform(engine), uniform(engine)});
  }
  for (int i = 0; i < 4; ++i) {
    few.add({uniform(engine), uniform(engine), 0.0F});
  }

  EXPECT_EQ(blob.surface, Surface::kUnknown);
  EXPECT_EQ(few.surface, Surface::kUnknown);
}

}  // namespace
}  // namespace slamd::map
