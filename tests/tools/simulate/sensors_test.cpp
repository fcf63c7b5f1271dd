#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"
#include "drivers/gnss/nmea.hpp"
#include "drivers/velodyne/position.hpp"
#include "decoded.hpp"
#include "tools/simulate/nmea.hpp"

namespace slamd::simulate {
namespace {


Drive drive_with(LidarKind lidar, const std::string& world = "town") {
  Drive drive;
  drive.lidar = lidar;
  drive.world = world;
  drive.duration_s = 20.0;
  drive.rest_s = 1.0;
  return drive;
}

TEST(SpinningLidar, IsReadByTheDecoderOfEachModelAndMode) {
  for (const LidarKind lidar : {LidarKind::kVlp16, LidarKind::kVlp32c, LidarKind::kHdl32e}) {
    for (const bool dual : {false, true}) {
      Drive drive = drive_with(lidar);
      drive.dual = dual;
      drive.range_noise_m = drive.beam_bias_m = 0.0;
      const Scene scene(drive);
      std::vector<double> residuals_m;

      decode_points(scene, 40, [&](const sensor::Point& point, double t_s, std::uint64_t) {
        const geometry::Se3 T_world_lidar = scene.motion().pose_at(t_s) * scene.mounting().T_base_lidar;
        const Eigen::Vector3d p(point.x_m, point.y_m, point.z_m);
        Hit hit;
        if (scene.world().cast(T_world_lidar.translation(), T_world_lidar.rotation() * p.normalized(), 300.0, 0, hit)) {
          residuals_m.push_back(p.norm() - hit.range_m);
        }
      });

      const Spread spread = spread_of(residuals_m);
      EXPECT_GT(spread.count, 20'000U) << name_of(lidar) << dual;
      EXPECT_LT(std::abs(spread.median), 0.001) << name_of(lidar) << dual;
      EXPECT_LT(spread.sigma, 0.006) << name_of(lidar) << dual;  // rounding of ranges and azimuths
    }
  }
}

TEST(SpinningLidar, SendsAtTheRatesOfItsManual) {
  struct Expected {
    LidarKind lidar;
    bool dual;
    double packet_us;
    std::uint8_t product;
  };
  // Source: velodyne description, sections 1 and 2.
  for (const Expected& e :
       {Expected{LidarKind::kVlp16, false, 1327.104, 0x22}, Expected{LidarKind::kVlp16, true, 663.552, 0x22},
        Expected{LidarKind::kVlp32c, false, 663.552, 0x28}, Expected{LidarKind::kHdl32e, false, 552.96, 0x21}}) {
    Drive drive = drive_with(e.lidar);
    drive.dual = e.dual;
    const Scene scene(drive);

    EXPECT_NEAR(1e6 * scene.lidar().packet_s(), e.packet_us, 1e-6);
    std::uint32_t last_us = 0;
    for (std::uint64_t index = 100; index < 105; ++index) {
      const SentPacket packet = scene.lidar().packet(index);
      ASSERT_EQ(packet.payload.size(), 1206U);
      EXPECT_EQ(packet.payload[1205], std::byte{e.product});
      EXPECT_EQ(packet.payload[1204], e.dual ? std::byte{0x39} : std::byte{0x37});
      const auto now_us = load_le<std::uint32_t>(packet.payload, 1200);
      if (last_us != 0) {
        EXPECT_NEAR(now_us - last_us, e.packet_us, 1.01);
      }
      last_us = now_us;
      const int step_cdeg =
          (load_le<std::uint16_t>(packet.payload, 202) - load_le<std::uint16_t>(packet.payload, 2) + 36000) % 36000;
      const double blocks = e.dual ? 6.0 : 12.0;
      EXPECT_NEAR(step_cdeg, 36000.0 * 10e-6 * e.packet_us / blocks * (e.dual ? 1.0 : 2.0), 2.0);
    }
  }
}

TEST(SpinningLidar, SendsTheLastReturnInEvenBlocksAndTheStrongestOtherInOddOnes) {
  Drive drive = drive_with(LidarKind::kVlp16);
  drive.dual = true;
  drive.mixed_pixels = true;
  drive.range_noise_m = 0.0;
  const Scene scene(drive);
  int two = 0;
  int one = 0;
  for (std::uint64_t index = 0; index < scene.packets(); index += 50) {
    const SentPacket packet = scene.lidar().packet(index);
    for (std::size_t pair = 0; pair < 6; ++pair) {
      for (std::size_t i = 0; i < 32; ++i) {
        const auto last = load_le<std::uint16_t>(packet.payload, 200 * pair + 4 + 3 * i);
        const auto other = load_le<std::uint16_t>(packet.payload, 200 * pair + 104 + 3 * i);
        ASSERT_EQ(last == 0, other == 0);
        ASSERT_GE(last, other);
        two += last > other ? 1 : 0;
        one += last == other && last > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(two, 200);
  EXPECT_GT(one, 10 * two);
}

TEST(SpinningLidar, SaysWhereAndWhenItIsInPositionPackets) {
  const Scene scene(drive_with(LidarKind::kVlp16));
  for (std::uint64_t index = 14; index < scene.packets(); index += 14 * 60) {
    const SentPacket packet = scene.spinning()->position_packet(index);
    velodyne::Position position;

    ASSERT_EQ(velodyne::decode_position(packet.payload, position), velodyne::PositionResult::kOk);

    EXPECT_EQ(position.pps, velodyne::PpsState::kLocked);
    const auto rmc = gnss::parse_rmc(position.text());
    ASSERT_TRUE(rmc && rmc->utc && rmc->place);
    const double t_s = static_cast<double>(index) * scene.lidar().packet_s();
    EXPECT_EQ(rmc->utc->time_since_epoch(), std::chrono::seconds(kStart_unix_s + static_cast<std::int64_t>(t_s)));
    const Geodetic place = geodetic_of(scene.motion().pose_at(std::floor(t_s)).translation());
    EXPECT_NEAR(rmc->place->latitude_deg, place.latitude_deg, 1e-6);
    EXPECT_NEAR(rmc->place->longitude_deg, place.longitude_deg, 1e-6);
  }
}

TEST(Avia, IsReadByTheDecoderInEachReturnModeWithItsTags) {
  struct Expected {
    LivoxReturns returns;
    bool spherical;
    std::uint8_t type;
    std::size_t bytes;
    double packet_us;
  };
  // Source: livox-sdk1 description, sections 5.3 and 5.4.
  for (const Expected& e :
       {Expected{LivoxReturns::kFirst, false, 2, 1362, 400.0}, Expected{LivoxReturns::kStrongest, false, 2, 1362, 400.0},
        Expected{LivoxReturns::kDual, false, 4, 1362, 200.0}, Expected{LivoxReturns::kTriple, false, 7, 1278, 125.0},
        Expected{LivoxReturns::kFirst, true, 3, 978, 400.0}, Expected{LivoxReturns::kStrongest, true, 3, 978, 400.0},
        Expected{LivoxReturns::kDual, true, 5, 786, 200.0}, Expected{LivoxReturns::kTriple, true, 8, 678, 125.0}}) {
    Drive drive = drive_with(LidarKind::kLivoxAvia);
    drive.returns = e.returns;
    drive.spherical = e.spherical;
    drive.mixed_pixels = true;
    drive.drops_per_m = 0.01;
    const Scene scene(drive);
    int echoes[3] = {};
    int air = 0;

    const SentPacket packet = scene.lidar().packet(5);
    decode_points(scene, 200, [&](const sensor::Point& point, double, std::uint64_t) {
      ++echoes[point.echo];
      EXPECT_EQ(point.tag >> 4 & 3, point.echo + 1);
      air += (point.tag >> 2 & 3) == 1 ? 1 : 0;
    });

    EXPECT_EQ(packet.payload.size(), e.bytes);
    EXPECT_EQ(packet.payload[9], std::byte{e.type});
    EXPECT_NEAR(1e6 * scene.lidar().packet_s(), e.packet_us, 1e-9);
    EXPECT_GT(echoes[0], 1000);
    EXPECT_GT(air, 10);
    EXPECT_EQ(echoes[1] > 0, e.returns == LivoxReturns::kDual || e.returns == LivoxReturns::kTriple);
    EXPECT_EQ(echoes[2] > 0, e.returns == LivoxReturns::kTriple);
  }
}

TEST(Mid360, SendsSdk2PacketsWithTheirChecksums) {
  const Scene scene(drive_with(LidarKind::kLivoxMid360, "indoor"));
  PacketStream stream(scene);
  std::uint64_t points = 0;
  std::uint64_t samples = 0;
  std::uint16_t next_point_count = 0;
  for (const SentPacket* packet = nullptr; stream.next(packet);) {
    const std::span<const std::byte> bytes(packet->payload);
    const bool imu = bytes[10] == std::byte{0};
    ASSERT_EQ(bytes.size(), imu ? 60U : 1380U);
    ASSERT_EQ(load_le<std::uint16_t>(bytes, 1), bytes.size());
    ASSERT_EQ(load_le<std::uint32_t>(bytes, 24), crc32_of(bytes.subspan(28)));
    if (!imu) {
      ASSERT_EQ(load_le<std::uint16_t>(bytes, 5), 96);
      ASSERT_EQ(load_le<std::uint16_t>(bytes, 7), next_point_count++);
    }
    (imu ? samples : points) += 1;
  }
  EXPECT_NEAR(static_cast<double>(points) / scene.motion().duration_s(), 2083.3, 1.0);
  EXPECT_NEAR(static_cast<double>(samples) / scene.motion().duration_s(), 200.0, 1.0);
}

TEST(Avia, SaysTheSameInSphericalCoordinatesToTheirResolution) {
  for (const LivoxReturns returns : {LivoxReturns::kStrongest, LivoxReturns::kTriple}) {
    Drive drive = drive_with(LidarKind::kLivoxAvia);
    drive.returns = returns;
    drive.mixed_pixels = true;
    const Scene cartesian(drive);
    drive.spherical = true;
    const Scene spherical(drive);
    std::vector<sensor::Point> expected;
    decode_points(cartesian, 300, [&](const sensor::Point& point, double, std::uint64_t) { expected.push_back(point); });
    std::size_t i = 0;

    decode_points(spherical, 300, [&](const sensor::Point& sut, double, std::uint64_t) {
      ASSERT_LT(i, expected.size());
      const sensor::Point& point = expected[i++];
      const Eigen::Vector3d a(point.x_m, point.y_m, point.z_m);
      const Eigen::Vector3d b(sut.x_m, sut.y_m, sut.z_m);
      ASSERT_NEAR(a.norm(), b.norm(), 0.002);
      ASSERT_LT(a.normalized().cross(b.normalized()).norm(), 0.01 * kDegree + 0.001 / a.norm());
      ASSERT_EQ(sut.offset_ns, point.offset_ns);
      ASSERT_EQ(sut.tag, point.tag);
    });

    EXPECT_EQ(i, expected.size());
    EXPECT_GT(i, 5000U);
  }
}

TEST(Crc32, MatchesTheGoldenPackets) {
  const char* check = "123456789";
  EXPECT_EQ(crc32_of(std::as_bytes(std::span(check, std::strlen(check)))), 0xCBF43926U);
  // The inertial packet of the livox-sdk2 description.
  const std::string hex =
      "003C00000001000700000001000000000000000000000000334BFFC21565EE71B048EA180AD7233C0AD7A3BC8FC2F53C0000000000000000"
      "0000803F";
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  EXPECT_EQ(crc32_of(std::span(bytes).subspan(28)), load_le<std::uint32_t>(bytes, 24));
}

/// A wall 20 m ahead of a sensor that stands still, and another 10 m behind the first one's edge.
World two_walls() {
  World world([](double, double) { return -50.0; }, {80.0, 80.0}, 1);
  world.add(OrientedBox{{40.05, 30.0, 0.0}, {0.05, 10.0, 20.0}, 0.0, 0.5F});
  world.add(OrientedBox{{50.05, 40.0, 0.0}, {0.05, 30.0, 20.0}, 0.0, 0.5F});
  world.build();
  return world;
}

TEST(Beam, GivesTwoEchoesAtAnEdgeWhenItHasAWidth) {
  const World world = two_walls();
  const Eigen::Vector3d origin(20.0, 30.0, 0.0);
  const Eigen::Vector3d edge = Eigen::Vector3d(20.0, 9.99, 0.0).normalized();
  const Beam wide(world, {.noise_m = 0.0, .beam_bias_m = 0.0, .full_signal = 1e-9, .mixed_pixels = true}, Noise(1, 1));
  const Beam line(world, {.noise_m = 0.0, .beam_bias_m = 0.0, .full_signal = 1e-9}, Noise(1, 1));
  int two = 0;
  for (std::uint64_t shot = 0; shot < 500; ++shot) {
    two += wide.shoot(origin, edge, 0.0, shot, 0.0).count == 2 ? 1 : 0;
    EXPECT_EQ(line.shoot(origin, edge, 0.0, shot, 0.0).count, 1);
  }
  EXPECT_GT(two, 50);
  EXPECT_LT(two, 450);
}

TEST(Beam, LosesMoreEchoesTheFartherTheDarkerAndTheMoreGrazing) {
  World world([](double, double) { return -50.0; }, {300.0, 80.0}, 1);
  world.add(OrientedBox{{40.05, 40.0, 0.0}, {0.05, 30.0, 20.0}, 0.0, 0.5F});
  world.build();
  const auto heard = [&](double distance_m, double full_signal, double yaw) {
    const Beam sut(world, {.noise_m = 0.0, .beam_bias_m = 0.0, .full_signal = full_signal}, Noise(1, 1));
    int count = 0;
    for (std::uint64_t shot = 0; shot < 2000; ++shot) {
      count += sut.shoot({40.0 - distance_m, 40.0, 0.0}, {std::cos(yaw), std::sin(yaw), 0.0}, 0.0, shot, 0.0).count;
    }
    return count / 2000.0;
  };

  EXPECT_NEAR(heard(10.0, 1e-2, 0.0), 0.5, 0.05);   // 0.5 / 10² over 0.01
  EXPECT_NEAR(heard(20.0, 1e-2, 0.0), 0.125, 0.03);
  EXPECT_NEAR(heard(10.0, 1e-2, 60.0 * kDegree), 0.5 * 0.5 * 0.25, 0.03);  // half as steep, twice as far
}

TEST(Beam, HearsRainAsOftenAsItFalls) {
  World world([](double, double) { return -50.0; }, {80.0, 80.0}, 1);
  world.build();
  const Beam sut(world, {.noise_m = 0.0, .min_range_m = 0.0, .full_signal = 1e-12, .drops_per_m = 0.02}, Noise(1, 1));
  int air = 0;
  for (std::uint64_t shot = 0; shot < 5000; ++shot) {
    const Echoes echoes = sut.shoot({40.0, 40.0, 0.0}, {1.0, 0.0, 0.0}, 0.0, shot, 0.0);
    air += echoes.count == 1 && echoes.echo[0].air ? 1 : 0;
  }
  EXPECT_NEAR(air / 5000.0, 1.0 - std::exp(-0.02 * 25.0), 0.03);  // drops are seen up to 25 m
}

TEST(InertialSensor, StopsAtItsLimitsAndWarmsUp) {
  const auto scenery = make_scenery("warehouse", 1, {});
  Ride ride;
  ride.vehicle = VehicleKind::kHandheld;
  ride.duration_s = 600.0;
  const Motion motion = drive(scenery->route(), ride, 1);
  InertialErrors errors;
  errors.gyro_limit_radps = 0.5;
  errors.accel_limit_mps2 = 10.0;
  InertialSensor sut(motion, {}, 100.0, errors, 1);
  double most_radps = 0.0;
  double most_mps2 = 0.0;
  double first_c = 0.0;
  double last_c = 0.0;
  double t_s = 0.0;
  for (InertialReading reading; sut.next(t_s, reading);) {
    most_radps = std::max(most_radps, reading.rate_radps.cwiseAbs().maxCoeff());
    most_mps2 = std::max(most_mps2, reading.force_mps2.cwiseAbs().maxCoeff());
    first_c = t_s == 0.0 ? reading.temp_c : first_c;
    last_c = reading.temp_c;
  }
  EXPECT_EQ(most_radps, 0.5);
  EXPECT_EQ(most_mps2, 10.0);
  EXPECT_GT(last_c, first_c + 10.0);
}

TEST(WheelSensor, CountsTheWayAndSlipsInTurns) {
  const auto scenery = make_scenery("warehouse", 1, {});
  Ride ride;
  ride.vehicle = VehicleKind::kSkidSteer;
  ride.duration_s = 240.0;
  const Motion motion = drive(scenery->route(), ride, 1);
  WheelErrors errors;
  errors.scale = errors.noise = errors.slip_chance = 0.0;
  WheelSensor sut(motion, 50.0, errors, 1);
  double way_m = 0.0;
  double turned = 0.0;
  double truly_turned = 0.0;
  WheelReading reading;
  Eigen::Vector3d last = motion.pose_at(0.0).translation();
  for (double t_s = 0.0; sut.next(t_s, reading);) {
    const Eigen::Vector3d now = motion.pose_at(t_s).translation();
    way_m += (now - last).norm();
    last = now;
    turned += std::abs(reading.w_radps) / 50.0;
    truly_turned += std::abs(motion.at(t_s).rate_base_radps.z()) / 50.0;
  }
  EXPECT_NEAR(0.5 * static_cast<double>(reading.left_ticks + reading.right_ticks) / errors.ticks_per_m, way_m,
              0.01 * way_m);
  EXPECT_NEAR(turned / truly_turned, 1.0 + errors.slip_in_turns, 0.01);
}

TEST(GnssSensor, IsAsWrongAsItsErrorsSayAndHasOutages) {
  const auto scenery = make_scenery("harbour", 1, {});
  const Motion motion = scenery->tour(1200.0, 1.6, 0.0, 0.45);
  GnssErrors errors;
  errors.multipath_chance = 0.0;
  GnssSensor sut(motion, {}, 5.0, errors, 1);
  const double metres_per_degree = 111'266.0;  // of latitude, at 52.4°
  double sum = 0.0;
  int fixes = 0;
  int none = 0;
  GnssReading reading;
  for (double t_s = 0.0; sut.next(t_s, reading);) {
    if (reading.quality == 0) {
      ++none;
      continue;
    }
    ++fixes;
    const double north_m = (reading.place.latitude_deg - kOriginLatitude_deg) * metres_per_degree;
    sum += std::pow(north_m - motion.pose_at(t_s).translation().y(), 2);
  }
  EXPECT_GT(none, 10);
  EXPECT_GT(fixes, 10 * none / 2);
  EXPECT_NEAR(std::sqrt(sum / fixes), std::hypot(errors.drift_m, errors.noise_m), 0.6);
}

TEST(Geodetic, MatchesTheEllipsoidsRadiiOfCurvature) {
  const double latitude = kOriginLatitude_deg * kDegree;
  const double w = std::sqrt(1.0 - 0.00669437999014 * std::pow(std::sin(latitude), 2));
  const double meridian_m = 6378137.0 * (1.0 - 0.00669437999014) / (w * w * w);
  const double normal_m = 6378137.0 / w;

  const Geodetic north = geodetic_of({0.0, 100.0, 0.0});
  const Geodetic east = geodetic_of({100.0, 0.0, 0.0});

  EXPECT_NEAR((north.latitude_deg - kOriginLatitude_deg) * kDegree * (meridian_m + kOriginAltitude_m), 100.0, 1e-3);
  EXPECT_NEAR(
      (east.longitude_deg - kOriginLongitude_deg) * kDegree * (normal_m + kOriginAltitude_m) * std::cos(latitude),
      100.0, 1e-3);
  EXPECT_NEAR(geodetic_of({0.0, 0.0, 7.0}).altitude_m, kOriginAltitude_m + 7.0, 1e-6);
}

}  // namespace
}  // namespace slamd::simulate
