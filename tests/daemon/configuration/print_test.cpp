#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "daemon/configuration/loader.hpp"

namespace slamd::configuration {
namespace {

Configuration reloaded(const std::string& printed) {
  Loader loader;
  loader.add_text(printed, "printed.toml");
  return loader.load();
}

/// A value that the key takes.
Value drawn(const Key& key, std::mt19937_64& engine) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); };
  if (key.path == "lidar.device.code") {
    return std::string();  // others go with some models only
  }
  if (key.path == "lidar.device.set_utc") {
    return false;  // likewise
  }
  if (key.path == "lidar.bind_address" || key.path == "lidar.source_address") {
    return std::string("10.20.30.40");
  }
  if (key.path == "imu.protocol") {
    return std::string("xsens");  // others go with some sources only
  }
  if (key.path == "imu.baud" || key.path == "gnss.baud") {
    return 230'400.0;
  }
  switch (key.kind) {
    case Key::Kind::kBoolean: return uniform(0.0, 1.0) < 0.5;
    case Key::Kind::kInteger: return std::floor(uniform(key.min, key.max));
    case Key::Kind::kNumber: return uniform(key.min, key.max);
    case Key::Kind::kText: return std::string("C:\\day \"one\"\t\x01\x7F\nü.csv");
    case Key::Kind::kName: return std::string("Robot_2-b");
    case Key::Kind::kChoice:
      return key.choices[static_cast<std::size_t>(uniform(0.0, static_cast<double>(key.choices.size())))];
    case Key::Kind::kVector3:
      return std::vector<double>{uniform(key.min, key.max), uniform(key.min, key.max), uniform(key.min, key.max)};
    case Key::Kind::kBoxes: break;
  }
  scan::Box box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.min_m[axis] = static_cast<float>(uniform(-5.0, 0.0));
    box.max_m[axis] = static_cast<float>(uniform(1.0, 5.0));
  }
  return std::vector<scan::Box>{box, box};
}

void expect_same_transform(const geometry::Se3& a, const geometry::Se3& b) {
  EXPECT_EQ(a.translation(), b.translation());
  EXPECT_LT((a.rotation() - b.rotation()).norm(), 1e-10);
}

TEST(PrintConfiguration, ReadsBackToTheSameConfigurationWhateverItHolds) {
  std::mt19937_64 engine(1);
  for (int i = 0; i < 300; ++i) {
    Configuration configuration;
    for (const Key& key : all_keys()) {
      key.set(configuration, drawn(key, engine));
    }

    const std::string printed = print_configuration(configuration);
    const Configuration again = reloaded(printed);

    ASSERT_EQ(print_configuration(again), printed);
    expect_same_transform(again.lidar.T_base_lidar, configuration.lidar.T_base_lidar);
    expect_same_transform(*again.imu.T_base_imu, *configuration.imu.T_base_imu);
    EXPECT_EQ(again.lidar.source, configuration.lidar.source);
    EXPECT_EQ(again.lcm.prefix, configuration.lcm.prefix);
    EXPECT_EQ(again.lidar.scan_period, configuration.lidar.scan_period);
    EXPECT_EQ(again.odometry.preprocess.self_filter.max_range_m, configuration.odometry.preprocess.self_filter.max_range_m);
  }
}

TEST(PrintConfiguration, ReadsBackWhatEachKeyHoldsAtItsLimits) {
  for (const Key& key : all_keys()) {
    if (key.kind != Key::Kind::kNumber && key.kind != Key::Kind::kInteger && key.kind != Key::Kind::kVector3) {
      continue;
    }
    for (const double limit : {key.min, key.max}) {
      Configuration configuration;
      key.set(configuration, key.kind == Key::Kind::kVector3 ? Value(std::vector<double>(3, limit)) : Value(limit));

      const std::string printed = print_configuration(configuration);

      EXPECT_EQ(print_configuration(reloaded(printed)), printed) << key.path;
    }
  }
}

TEST(PrintConfiguration, KeepsASensorThatLooksStraightDown) {
  Configuration configuration;
  find_key("lidar.T_base_lidar.rpy_deg")->set(configuration, std::vector<double>{30.0, 90.0, 0.0});

  expect_same_transform(reloaded(print_configuration(configuration)).lidar.T_base_lidar, configuration.lidar.T_base_lidar);
}

TEST(PrintConfiguration, WritesNumbersAsAPersonWould) {
  Configuration configuration;
  configuration.odometry.preprocess.self_filter.max_range_m = 100.0F;
  configuration.odometry.update.association.planar_std_m = 0.05F;
  configuration.lidar.T_base_lidar.translation() = {100.0, 0.0, 0.26};

  const std::string printed = print_configuration(configuration);

  EXPECT_NE(printed.find("\nmax_range_m = 100.0\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("\nplanar_std_m = 0.05\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("\nT_base_lidar.xyz_m = [100.0, 0.0, 0.26]\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("\nT_base_lidar.rpy_deg = [0.0, 0.0, 0.0]\n"), std::string::npos) << printed;
}

TEST(PrintConfiguration, LeavesOutThePlaceOfAnImuThatHasNone) {
  EXPECT_EQ(print_configuration(Configuration{}).find("T_base_imu"), std::string::npos);
}

TEST(PrintReference, HasARowForEachKeyWithDefaultRangeAndMeaning) {
  const std::string reference = print_reference();

  for (const Key& key : all_keys()) {
    EXPECT_NE(reference.find("| `" + key.path + "` | "), std::string::npos) << key.path;
    EXPECT_NE(reference.find(key.allowed() + " | " + key.help), std::string::npos) << key.path;
    EXPECT_FALSE(key.help.empty()) << key.path;
  }
}

TEST(Keys, HaveDefaultsThatTheyTakeThemselves) {
  const Configuration defaults{};
  for (const Key& key : all_keys()) {
    const Value held = key.get(defaults);
    const bool is_unset = key.optional && std::holds_alternative<std::vector<double>>(held);
    if (!is_unset && (key.kind == Key::Kind::kNumber || key.kind == Key::Kind::kInteger)) {
      const double value = std::get<double>(held);
      EXPECT_GE(value, key.min) << key.path;
      EXPECT_LE(value, key.max) << key.path;
    }
  }
}

}  // namespace
}  // namespace slamd::configuration
