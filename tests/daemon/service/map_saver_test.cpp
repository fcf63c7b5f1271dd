#include "daemon/service/map_saver.hpp"

#include <gtest/gtest.h>

#include "daemon/configuration/loader.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::service {
namespace {

using MapSaverTest = scratch::ScratchFolder;

configuration::Configuration without_mapping() {
  configuration::Loader loader;
  loader.add_text(R"(
[[lidar]]
model = "vlp16"
port = 22678
position_port = 28418
bind_address = "127.0.0.1"
[lcm]
url = "memq://"
[map]
max_cells = 1000
[mapping]
use = false
)",
                  "test");
  return loader.load();
}

/// Says that odom has begun, as publish does with its first scan.
void begin_odom(pipeline::Pipeline& pipeline) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): no thread was started, so that this one is publish
  const_cast<pipeline::Rings&>(pipeline.rings()).scan_poses.try_push({pipeline.epoch(), Stamp{}, geometry::Se3()});
}

TEST_F(MapSaverTest, TakesTheNextSaveAfterOneWhoseMapCouldNotBeMade) {
  const transport::HostClock clock;
  pipeline::Pipeline pipeline(without_mapping(), clock);
  std::string deep = folder_.string();
  while (deep.size() + 201 < 4'070) {
    deep += "/" + std::string(200, 'd');
  }
  deep += "/" + std::string(4'080 - deep.size() - 1, 'd');
  MapSaver sut(deep, pipeline);  // "/.name.part" makes 4,091 bytes of it, which is a path; with "/map.ply" it is none
  EXPECT_EQ(sut.begin(1, "name", geometry::Se3()), "there is no map yet");
  begin_odom(pipeline);

  const std::string fault = sut.begin(2, "name", geometry::Se3());

  EXPECT_NE(fault.find("/.name.part/map.ply: File name too long"), std::string::npos) << fault;
  EXPECT_FALSE(sut.is_busy());
  EXPECT_FALSE(sut.run_once());
  EXPECT_TRUE(std::filesystem::is_empty(deep));
  sut.set_directory(folder_ / "short");
  EXPECT_EQ(sut.begin(3, "name", geometry::Se3()), "");
  EXPECT_TRUE(sut.is_busy());
}

}  // namespace
}  // namespace slamd::service
