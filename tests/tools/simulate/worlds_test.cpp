#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/bytes.hpp"
#include "drivers/recording/packet.hpp"
#include "temporary_folder.hpp"
#include "tools/simulate/scenery.hpp"
#include "tools/simulate/truth.hpp"

namespace slamd::simulate {
namespace {

constexpr double kFar_m = 100.0;

/// Rays from a tour, in all directions but steep ones, at all times.
class RayGenerator {
 public:
  RayGenerator(const Motion& motion, std::uint64_t seed) : motion_(motion), engine_(seed) {}

  void next() {
    t_s = uniform(0.0, motion_.duration_s());
    origin = motion_.pose_at(t_s).translation() + Eigen::Vector3d(0.0, 0.0, uniform(0.0, 1.0));
    const double azimuth = uniform(-M_PI, M_PI);
    const double elevation = uniform(-0.7, 0.7);
    direction = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
  }

  double t_s = 0.0;
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }

  const Motion& motion_;
  std::mt19937_64 engine_;
};

class EveryWorld : public testing::TestWithParam<std::string> {};

TEST_P(EveryWorld, CastsAsTryingEverythingDoesMoversAndAll) {
  for (const std::uint64_t seed : {1U, 5U}) {
    const auto sut = make_scenery(GetParam(), seed, {4, 6});
    const Motion motion = sut->tour(120.0, 1.6, 0.0, 0.45);
    RayGenerator rays(motion, seed);
    int hits = 0;
    for (std::uint64_t ray = 0; ray < 600; ++ray) {
      rays.next();
      Hit fast;
      Hit slow;

      const bool fast_met = sut->world().cast(rays.origin, rays.direction, kFar_m, ray, fast, rays.t_s);
      const bool slow_met = sut->world().cast_brute_force(rays.origin, rays.direction, kFar_m, ray, slow, rays.t_s);

      ASSERT_EQ(fast_met, slow_met) << "seed " << seed << ", ray " << ray;
      hits += fast_met ? 1 : 0;
      if (fast_met) {
        ASSERT_NEAR(fast.range_m, slow.range_m, 1e-6) << "seed " << seed << ", ray " << ray;
      }
    }
    EXPECT_GT(hits, 200);
  }
}

TEST_P(EveryWorld, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto sut = make_scenery(GetParam(), 3, {});
  const auto same = make_scenery(GetParam(), 3, {});
  const auto other = make_scenery(GetParam(), 4, {});
  const Motion motion = sut->tour(120.0, 1.6, 0.0, 0.45);
  RayGenerator rays(motion, 3);
  int as_other = 0;
  for (std::uint64_t ray = 0; ray < 400; ++ray) {
    rays.next();
    Hit a;
    Hit b;
    Hit c;
    const bool met = sut->world().cast(rays.origin, rays.direction, kFar_m, ray, a);

    ASSERT_EQ(same->world().cast(rays.origin, rays.direction, kFar_m, ray, b), met);
    ASSERT_EQ(a.range_m, b.range_m);
    as_other +=
        other->world().cast(rays.origin, rays.direction, kFar_m, ray, c) == met && a.range_m == c.range_m ? 1 : 0;
  }
  EXPECT_LT(as_other, 380);
}

TEST_P(EveryWorld, LeadsItsToursOverTheGroundAndClearOfEverything) {
  for (const VehicleKind vehicle : {VehicleKind::kAckermann, VehicleKind::kSkidSteer}) {
    const auto sut = make_scenery(GetParam(), 2, {});
    Ride ride;
    ride.vehicle = vehicle;
    ride.duration_s = 900.0;

    const Motion motion = drive(sut->route(), ride, 2);

    for (double t = 0.0; t < motion.duration_s(); t += 1.0) {
      const Eigen::Vector3d p = motion.pose_at(t).translation();
      EXPECT_NEAR(p.z() - sut->world().ground(p.x(), p.y()), ride.height_m, 0.15) << "at " << t << " s";
      for (int i = 0; i < 12; ++i) {
        Hit hit;
        const double azimuth = i * M_PI / 6.0;
        EXPECT_FALSE(sut->world().cast(p, {std::cos(azimuth), std::sin(azimuth), 0.0}, 0.45, 0, hit))
            << "at " << t << " s";
      }
    }
  }
}

TEST_P(EveryWorld, IsRevisitedInBothDirections) {
  const auto sut = make_scenery(GetParam(), 1, {});

  const std::vector<TrueLoop> loops = true_loops(sut->tour(1500.0, 1.6, 3.0, 0.45));

  const auto count = [&](double low, double high) {
    return std::count_if(loops.begin(), loops.end(),
                         [&](const TrueLoop& l) { return std::abs(l.yaw_rad) >= low && std::abs(l.yaw_rad) <= high; });
  };
  EXPECT_GT(count(0.0, 0.3), 10);
  EXPECT_GT(count(2.84, 3.15), 10);
}

INSTANTIATE_TEST_SUITE_P(Worlds, EveryWorld, testing::ValuesIn(world_names()),
                         [](const auto& world) { return world.param; });

TEST(Campus, HasSlopesOfUpToEightPercent) {
  double steepest = 0.0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const auto sut = make_scenery("campus", seed, {});
    for (double x = 5.0; x < 235.0; x += 5.0) {
      for (double y = 5.0; y < 235.0; y += 5.0) {
        const double dx = sut->world().ground(x + 1.0, y) - sut->world().ground(x - 1.0, y);
        const double dy = sut->world().ground(x, y + 1.0) - sut->world().ground(x, y - 1.0);
        steepest = std::max(steepest, 0.5 * std::hypot(dx, dy));
      }
    }
  }
  EXPECT_GT(steepest, 0.06);
  EXPECT_LT(steepest, 0.10);
}

TEST(Tunnel, IsTwoHundredToFourHundredMetresLong) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const auto sut = make_scenery("tunnel", seed, {});
    const double length_m = sut->world().extent_m().x() - 36.0;
    EXPECT_GE(length_m, 200.0);
    EXPECT_LE(length_m, 400.0);
  }
}

TEST(World, MeetsAMoverWhereItIsAtThatTimeOnly) {
  World sut([](double, double) { return 0.0; }, {60.0, 60.0}, 1);
  Mover mover;
  mover.path = sampled({{10.0, 10.0}, {50.0, 10.0}, {50.0, 50.0}, {10.0, 50.0}});
  mover.boxes = {{{0.0, 0.0, 1.0}, {1.0, 0.5, 1.0}, 0.0, 0.7F}};
  mover.speed_mps = 2.0;
  sut.add(mover);
  sut.build();
  Hit hit;

  // After 10 s it is at (30, 10), heading along x.
  EXPECT_TRUE(sut.cast({30.0, 20.0, 1.0}, {0.0, -1.0, 0.0}, 50.0, 0, hit, 10.0));
  EXPECT_NEAR(hit.range_m, 9.5, 1e-9);
  EXPECT_FALSE(sut.cast({30.0, 20.0, 1.0}, {0.0, -1.0, 0.0}, 15.0, 0, hit, 14.0));
  EXPECT_FALSE(sut.cast({30.0, 20.0, 1.0}, {0.0, -1.0, 0.0}, 15.0, 0, hit, World::kStandingOnly));
}

class Mesh : public TemporaryFolder {
 protected:
  /// A room of 8 by 6 by 3 m, corners from (−4, −3, 0).
  std::filesystem::path room(bool binary) const {
    const std::filesystem::path file = folder_ / "room.ply";
    std::ofstream stream(file, std::ios::binary);
    stream << "ply\nformat " << (binary ? "binary_little_endian" : "ascii")
           << " 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 6\nproperty "
              "list uchar int vertex_indices\nend_header\n";
    const int faces[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (int i = 0; i < 8; ++i) {
      const float p[3] = {(i + 1) % 4 < 2 ? -4.0F : 4.0F, i % 4 < 2 ? -3.0F : 3.0F, i < 4 ? 0.0F : 3.0F};
      if (binary) {
        stream.write(reinterpret_cast<const char*>(p), sizeof p);
      } else {
        stream << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
      }
    }
    for (const auto& face : faces) {
      if (binary) {
        stream.put(4);
        stream.write(reinterpret_cast<const char*>(face), sizeof face);
      } else {
        stream << "4 " << face[0] << ' ' << face[1] << ' ' << face[2] << ' ' << face[3] << '\n';
      }
    }
    return file;
  }
};

TEST_F(Mesh, IsAWorldWithItsFacesWhereTheyAre) {
  for (const bool binary : {false, true}) {
    const Scenery sut = make_mesh_world(room(binary), 1);
    const Eigen::Vector3d middle(5.0, 4.0, 1.0);  // moved so that it begins a metre from (0, 0)
    Hit hit;

    ASSERT_TRUE(sut.world().cast(middle, {1.0, 0.0, 0.0}, 50.0, 0, hit));
    EXPECT_NEAR(hit.range_m, 4.0, 1e-5);
    ASSERT_TRUE(sut.world().cast(middle, {0.0, -1.0, 0.0}, 50.0, 0, hit));
    EXPECT_NEAR(hit.range_m, 3.0, 1e-5);
    ASSERT_TRUE(sut.world().cast(middle, {0.0, 0.0, 1.0}, 50.0, 0, hit));
    EXPECT_NEAR(hit.range_m, 2.0, 1e-5);
    EXPECT_NEAR(sut.tour(20.0, 0.5, 0.0, 0.45).pose_at(10.0).translation().z(), 0.45, 0.05);
  }
}

TEST_F(Mesh, IsRefusedInOneLineWhenItHasNoFacesOrBadOnes) {
  std::ofstream(folder_ / "no_faces.ply") << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                                             "float y\nproperty float z\nend_header\n0 0 0\n";
  std::ofstream(folder_ / "bad.ply")
      << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 7\n";
  std::ofstream(folder_ / "text.ply") << "hello\n";

  for (const char* name : {"no_faces.ply", "bad.ply", "text.ply", "absent.ply"}) {
    EXPECT_THROW(make_mesh_world(folder_ / name, 1), recording::RecordingError) << name;
  }
}

}  // namespace
}  // namespace slamd::simulate
