#include "daemon/service/reload.hpp"

#include <gtest/gtest.h>

#include "daemon/configuration/loader.hpp"

namespace slamd::service {
namespace {

using configuration::Configuration;

Configuration configuration_of(std::initializer_list<const char*> overrides) {
  configuration::Loader loader;
  loader.add_override("lidar.model=vlp16");
  for (const char* key_value : overrides) {
    loader.add_override(key_value);
  }
  return loader.load();
}

TEST(Reload, SaysThatNothingHasChanged) {
  Configuration running = configuration_of({});

  const Reload reload = take_over(running, configuration_of({}));

  EXPECT_EQ(in_words(reload), "configuration read again: nothing has changed");
}

TEST(Reload, TakesWhatMayChange) {
  Configuration running = configuration_of({});

  const Reload reload =
      take_over(running, configuration_of({"realtime.priority=60", "output.save_directory=/tmp"}));

  EXPECT_EQ(running.realtime.priority, 60);
  EXPECT_EQ(running.output.save_directory, "/tmp");
  EXPECT_EQ(in_words(reload),
            "configuration read again: now output.save_directory \"\" → \"/tmp\", "
            "realtime.priority 50 → 60");
}

TEST(Reload, RefusesTheRestInWords) {
  Configuration running = configuration_of({});

  const Reload reload =
      take_over(running, configuration_of({"lidar.port=2369", "log.repeat_period_ms=1000"}));

  EXPECT_EQ(running.lidar.port, 0);
  EXPECT_EQ(in_words(reload),
            "configuration read again: now log.repeat_period_ms 5000.0 → 1000.0; refused until a "
            "restart: lidar.port 0 → 2369");
}

TEST(Reload, NamesAKeyThatWasUnset) {
  Configuration running = configuration_of({});
  Configuration wanted = running;
  wanted.imu.T_base_imu =
      geometry::Se3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1.0, 0.0, 0.0));

  const Reload reload = take_over(running, wanted);

  ASSERT_FALSE(reload.refused.empty());
  EXPECT_EQ(reload.refused.front(), "imu.T_base_imu.xyz_m unset → [1.0, 0.0, 0.0]");
}

TEST(Reload, RefusesThatARemovedKeyStays) {
  Configuration running = configuration_of({});
  running.imu.T_base_imu = geometry::Se3{};

  const Reload reload = take_over(running, configuration_of({}));

  EXPECT_TRUE(reload.taken.empty());
  EXPECT_FALSE(reload.refused.empty());
}

}  // namespace
}  // namespace slamd::service
