#include "tools/simulate/can_log.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "daemon/configuration/loader.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/replay/can_log.hpp"

namespace slamd::simulate {
namespace {

constexpr double kRate_hz = 400.0;

class SimulatedCan : public scratch::ScratchFolder, public testing::WithParamInterface<imu::Protocol> {
 protected:
  SimulatedCan() {
    drive_.duration_s = 6.0;
    drive_.rest_s = 1.0;
    drive_.imu_rate_hz = kRate_hz;
    drive_.can = GetParam();
    std::filesystem::create_directories(folder_);
  }

  configuration::Configuration configuration() const {
    configuration::Loader loader;
    loader.add_text(recording_toml(drive_), "recording.toml");
    return loader.load();
  }

  Drive drive_;
};

TEST_P(SimulatedCan, SaysWithinAnLsbWhatTheInertialSensorMeasures) {
  const bool is_xsens = GetParam() == imu::Protocol::kXsens;
  const double rate_lsb = is_xsens ? 1.0 / 512.0 : M_PI / 180.0 / 128.0;
  const double force_lsb = is_xsens ? 1.0 / 256.0 : 0.01;
  const Scene scene(drive_);
  write_can_log(scene, folder_ / "can.log");
  replay::CanLogImu sut(folder_ / "can.log", configuration());
  InertialSensor sensor = scene.imu();
  sensor::ImuSample sample;
  InertialReading reading;
  double t_s = 0.0;
  int samples = 0;

  for (; sut.next(sample); ++samples) {
    ASSERT_TRUE(sensor.next(t_s, reading));
    const sensor::ImuSample truth = written_sample(t_s, reading);
    EXPECT_LE((sample.angular_rate_radps - truth.angular_rate_radps).cwiseAbs().maxCoeff(), 0.51 * rate_lsb);
    EXPECT_LE((sample.specific_force_mps2 - truth.specific_force_mps2).cwiseAbs().maxCoeff(), 0.51 * force_lsb);
    EXPECT_NEAR(to_seconds(sample.stamp - truth.stamp), 0.0, 1.1e-3);
  }

  EXPECT_FALSE(sensor.next(t_s, reading));
  EXPECT_GT(samples, 6 * kRate_hz);
  for (const auto& [name, count] : sut.counts()) {
    EXPECT_TRUE(name == "sample" || name == "other") << name << " " << count;
  }
}

TEST_P(SimulatedCan, SaysToTheMillimetreASecondWhatTheWheelsMeasure) {
  const Scene scene(drive_);
  write_can_log(scene, folder_ / "can.log");
  replay::CanLogWheels sut(folder_ / "can.log", configuration());
  WheelSensor wheels(scene.motion(), kWheel_hz, drive_.wheel_errors, drive_.seed);
  sensor::WheelSample sample;
  WheelReading reading;
  double t_s = 0.0;

  while (sut.next(sample)) {
    ASSERT_TRUE(wheels.next(t_s, reading));
    EXPECT_NEAR(sample.speed_mps, reading.v_mps, 0.51e-3);
    EXPECT_NEAR(sample.turn_rate_radps, reading.w_radps, 1.01e-3 / drive_.wheel_errors.track_m);
    EXPECT_NEAR(to_seconds(sample.stamp - stamp_at(t_s)), 0.0, 1e-3);
  }

  EXPECT_FALSE(wheels.next(t_s, reading));
}

INSTANTIATE_TEST_SUITE_P(All, SimulatedCan, testing::Values(imu::Protocol::kXsens, imu::Protocol::kAceinna),
                         [](const auto& named) { return std::string(name_of(named.param)); });

TEST(CanImu, WritesTheGoldenVectorsOfBothSensors) {
  sensor::ImuSample sample{stamp_at(0.0), {0.009765625, -0.01953125, 0.5}, {0.05078125, -0.12109375, 9.80859375}};
  const auto hex = [](const transport::CanFrame& frame) {
    std::string text;
    for (const std::byte byte : frame.bytes()) {
      char digits[3];
      std::snprintf(digits, sizeof digits, "%02X", std::to_integer<unsigned>(byte));
      text += digits;
    }
    return text;
  };

  const CanImu::Frames xsens = CanImu(imu::Protocol::kXsens).frames_of(sample);
  sample.specific_force_mps2 = {-0.34, 0.12, -9.81};  // y first on the wire
  sample.angular_rate_radps = M_PI / 180.0 * Eigen::Vector3d(-2.5, 1.0, 30.0);
  const CanImu::Frames aceinna = CanImu(imu::Protocol::kAceinna).frames_of(sample);

  ASSERT_EQ(xsens.size(), 4U);
  EXPECT_EQ(hex(xsens[2]), "0005FFF60100");
  EXPECT_EQ(hex(xsens[3]), "000DFFE109CF");
  ASSERT_EQ(aceinna.size(), 2U);
  EXPECT_EQ(hex(aceinna[0]).substr(0, 12), "0C7DDE7C2B79");
  EXPECT_EQ(hex(aceinna[1]).substr(0, 12), "807DC07B008C");
}

}  // namespace
}  // namespace slamd::simulate
