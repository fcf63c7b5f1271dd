#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/cli/cli.hpp"
#include "tools/loopnet/place_file.hpp"
#include "tools/loopnet/place_visit.hpp"
#include "tools/loopnet/place_world.hpp"
#include "tools/loopnet/recorded_places.hpp"

namespace {

using namespace slamd;
using namespace slamd::loopnet;

struct Options {
  std::string out;
  std::vector<std::string> worlds{"streets", "grounds", "floors"};
  std::vector<std::string> sensors{"vlp16"};
  std::uint64_t seed = 1;
  std::size_t count = 24;
  std::size_t places = 36;
  std::size_t visits = 3;
  std::string submaps = "any";
  std::vector<std::string> clouds;
  std::vector<std::string> poses;
  RecordedPlaces recorded;
  bool avia = false;
};

void declare_worlds(const cli::Command& app, Options& options) {
  app.option("--out", options.out, "Folder for images.npy, contexts.npy and visits.npy").required();
  app.option("--worlds", options.worlds, "Kinds of worlds, in turn").one_of(place_world_names()).shows_default();
  app.option("--sensors", options.sensors, "One for each world, in turn: vlp16, avia, hdl64, spinning")
      .one_of({"vlp16", "avia", "hdl64", "spinning"})
      .shows_default();
  app.option("--seed", options.seed, "Of the first world; the others follow").shows_default();
  app.option("--count", options.count, "Number of worlds").positive().shows_default();
  app.option("--places", options.places, "Places in each world").positive().shows_default();
  app.option("--visits", options.visits, "Visits to each place").positive().shows_default();
  app.option("--submaps", options.submaps, "any; single: one scan each, but for an Avia; mapped: as core/mapping keeps them")
      .one_of({"any", "single", "mapped"})
      .shows_default();
}

void declare_recording(const cli::Command& app, Options& options) {
  app.option("--out", options.out, "Folder for images.npy, contexts.npy and visits.npy").required();
  app.option("--clouds", options.clouds, "Folders of *.bin, *.pcd or *.ply, numbered; each a world of its own").required();
  app.option("--poses", options.poses, "Their KITTI rows, T_world_lidar; the number in a cloud's name is its row").required();
  app.option("--submap", options.recorded.submap, "Clouds that a keyframe is shown with: its own and those before").positive().shows_default();
  app.option("--apart", options.recorded.apart_m, "Least distance of keyframes, m").shows_default();
  app.option("--seed", options.recorded.seed, "Of the yaws by which keyframes are turned").shows_default();
  app.flag("!--no-turn", options.recorded.turn, "Leave keyframes as they look");
  app.flag("--indoor", options.recorded.indoor, "Places are 2 m apart, not 5");
  app.flag("--avia", options.avia, "Headings more than 40 degrees apart see different things");
}

float number_of(const std::string& name) {
  const std::vector<std::string>& names = place_world_names();
  return static_cast<float>(std::find(names.begin(), names.end(), name) - names.begin());
}

int make_places(const Options& options) {
  const SubmapKind submaps = options.submaps == "any"      ? SubmapKind::kAny
                             : options.submaps == "single" ? SubmapKind::kSingle
                                                           : SubmapKind::kMapped;
  PlaceFile file(options.out);
  cli::Progress progress("places");
  for (std::size_t i = 0; i < options.count; ++i) {
    progress.show(static_cast<double>(i) / static_cast<double>(options.count));
    const std::string& name = options.worlds[i % options.worlds.size()];
    // Kinds and sensors do not go in step.
    const std::string& sensor = options.sensors[(i / options.worlds.size() + i) % options.sensors.size()];
    const PlaceWorld world = make_place_world(name, options.seed + i);
    Visitor visitor(world, {sensor_kind(sensor), submaps}, options.seed + i);
    for (const Visit& visit : visitor.visit(options.places, options.visits)) {
      const Eigen::Vector3d& p = visit.T_world_level.translation();
      file.add({static_cast<float>(i), static_cast<float>(visit.place), number_of(name),
                static_cast<float>(sensor_kind(sensor)), world.indoor ? 1.0F : 0.0F, static_cast<float>(p.x()),
                static_cast<float>(p.y()), static_cast<float>(p.z()), static_cast<float>(visit.heading_rad)},
               visit.image, visit.context);
    }
  }
  progress.show(1.0);
  file.close();
  std::printf("%zu visits\n", file.rows());
  return 0;
}

int convert_recordings(Options& options) {
  if (options.clouds.size() != options.poses.size()) {
    throw cli::UsageError("as many --poses as --clouds, please");
  }
  PlaceFile file(options.out);
  options.recorded.sensor = options.avia ? static_cast<float>(PlaceSensor::Kind::kAvia) : -1.0F;
  for (std::size_t i = 0; i < options.clouds.size(); ++i) {
    options.recorded.clouds = options.clouds[i];
    options.recorded.poses = options.poses[i];
    options.recorded.world = static_cast<float>(i);
    add_recorded_places(options.recorded, file);
    ++options.recorded.seed;
  }
  file.close();
  std::printf("%zu visits\n", file.rows());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  cli::Command recording;
  return cli::run_program(
      argc, argv, "make_places",
      "Makes what Loop-Net is trained and tested with: polar images of places that are visited again.",
      [&](const cli::Command& app) {
        app.require_command();
        declare_worlds(app.command("worlds", "Simulates visits to places of random worlds"), options);
        recording = app.command("recording", "Takes clouds with known poses");
        declare_recording(recording, options);
      },
      [&] { return recording.is_given() ? convert_recordings(options) : make_places(options); });
}
