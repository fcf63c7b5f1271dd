#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "drivers/recording/tum.hpp"
#include "drivers/storage/pcd_writer.hpp"
#include "drivers/storage/ply_writer.hpp"
#include "drivers/storage/session_writer.hpp"
#include "tools/cli/cli.hpp"
#include "tools/map/navigation_grid.hpp"
#include "tools/map/reoptimise.hpp"
#include "tools/map/session_cloud.hpp"
#include "tools/map/session_info.hpp"
#include "tools/plot/point_picture.hpp"

namespace {

using namespace slamd;

constexpr std::size_t kPictureWidth = 1600;

struct Options {
  std::string session;
  bool json = false;
  // export
  std::string ply;
  std::string pcd;
  std::string tum;
  std::string top;
  std::string slice;
  std::string grid;
  float spacing_m = 0.1F;
  double slice_m = 1.0;
  double slice_width_m = 0.2;
  double base_height_m = 0.0;
  map::GridOptions grid_options;
  // optimise
  std::string out;
};

storage::Session read(const std::string& folder) {
  cli::Progress progress("reading");
  return storage::read_session(folder, [&](double share) { progress.show(share); });
}

int info(const Options& options) {
  const storage::Session session = read(options.session);
  std::fputs((options.json ? map::info_json(session) : map::info_text(session)).c_str(), stdout);
  return 0;
}

void warn_of(const storage::Session& session) {
  for (const storage::SessionDamage& damage : session.damage) {
    std::fprintf(stderr, "slamd-map: %s: %llu bytes from %llu are left out: %s\n", damage.segment.c_str(),
                 static_cast<unsigned long long>(damage.bytes), static_cast<unsigned long long>(damage.offset), damage.what.c_str());
  }
}

void write_picture(const std::string& file, const std::vector<Eigen::Vector3f>& points, const std::vector<Eigen::Vector3f>& way) {
  const plot::Camera from_above;
  const auto picture = plot::picture_of(points, from_above, plot::window_of(points, way, from_above), kPictureWidth);
  const std::vector<std::byte> png = plot::png_of(picture.image);
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  stream.close();
  if (!stream) {
    throw std::runtime_error(file + ": cannot be written");
  }
}

void write_way(const std::string& file, const storage::Session& session) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!stream) {
    throw std::runtime_error(file + ": cannot be written");
  }
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    recording::write_tum_line(stream.get(), session.keyframes[i].stamp, session.T_map_base[i]);
  }
  const bool is_good = std::ferror(stream.get()) == 0;
  if (std::fclose(stream.release()) != 0 || !is_good) {
    throw std::runtime_error(file + ": could not be written whole");
  }
}

void say_written(const std::string& file) { std::printf("written: %s\n", file.c_str()); }

int export_session(Options& options) {
  if ((options.ply + options.pcd + options.tum + options.top + options.slice + options.grid).empty()) {
    throw cli::UsageError("export: says nothing to write (--ply, --pcd, --tum, --top, --slice, --grid)");
  }
  const storage::Session session = read(options.session);
  warn_of(session);
  if (session.keyframes.empty()) {
    throw std::runtime_error(options.session + ": has no keyframe: there is nothing to write");
  }
  if (!(options.ply + options.pcd + options.top + options.slice).empty()) {
    cli::Progress progress("joining clouds");
    const auto points = map::cloud_of(session, options.spacing_m, [&](double share) { progress.show(share); });
    const auto way = map::way_of(session);
    if (!options.ply.empty()) {
      storage::PlyWriter writer(options.ply);
      for (const Eigen::Vector3f& p : points) {
        writer.write(p);
      }
      writer.close();
      say_written(options.ply);
    }
    if (!options.pcd.empty()) {
      storage::write_pcd(options.pcd, points);
      say_written(options.pcd);
    }
    if (!options.top.empty()) {
      write_picture(options.top, points, way);
      say_written(options.top);
    }
    if (!options.slice.empty()) {
      std::vector<Eigen::Vector3f> cut;
      for (const Eigen::Vector3f& p : points) {
        if (std::abs(p.z() - options.slice_m) < 0.5 * options.slice_width_m) {
          cut.push_back(p);
        }
      }
      write_picture(options.slice, cut, way);
      say_written(options.slice);
    }
  }
  if (!options.tum.empty()) {
    write_way(options.tum, session);
    say_written(options.tum);
  }
  if (!options.grid.empty()) {
    cli::Progress progress("drawing the grid");
    options.grid_options.ground_m = -options.base_height_m;
    map::write_grid(map::grid_of(session, options.grid_options, [&](double share) { progress.show(share); }), options.grid);
    say_written(options.grid + ".pgm");
    say_written(options.grid + ".yaml");
  }
  return 0;
}

int optimise(const Options& options) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(options.out, none)) {
    if (storage::is_segment_name(entry.path())) {
      throw cli::UsageError("--out " + options.out + ": holds a session already; give another folder");
    }
  }
  storage::Session session = read(options.session);
  warn_of(session);
  std::optional<map::Reoptimised> result;
  {
    cli::Progress progress("optimising");
    result = map::reoptimise(session, [&](double share) { progress.show(share); });
  }
  storage::SessionWriter writer(options.out, session.begin, {});
  std::vector<storage::SessionPose> poses;
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    writer.write(session.keyframes[i]);
    poses.push_back({session.keyframes[i].id, session.T_map_base[i]});
  }
  for (const storage::SessionLoop& loop : session.loops) {
    writer.write(loop);
  }
  writer.write(poses);
  writer.close();
  if (!writer.fault().empty()) {
    throw std::runtime_error(writer.fault());
  }
  std::printf("loops: %zu accepted (%zu taken in, %zu taken out); keyframes moved %.3f m at most\n", result->accepted, result->taken_in,
              result->taken_out, result->largest_move_m);
  say_written(options.out);
  return 0;
}

void declare(const cli::Command& app, Options& options) {
  app.require_command();
  const auto add = [&](const char* verb, const char* help) {
    const cli::Command command = app.command(verb, help);
    command.option("SESSION", options.session, "Folder of a session: DIR/session of slamd-replay").required();
    return command;
  };
  add("info", "Says what a session holds, and what is wrong with it").flag("--json", options.json, "Print JSON");
  const cli::Command to_files = add("export", "Writes the map as clouds, pictures or a grid");
  to_files.option("--ply", options.ply, "Cloud, binary PLY");
  to_files.option("--pcd", options.pcd, "Cloud, binary PCD");
  to_files.option("--tum", options.tum, "Poses of the keyframes, T_map_base");
  to_files.option("--top", options.top, "Picture from above, PNG");
  to_files.option("--slice", options.slice, "Picture of what lies at one height, PNG");
  to_files.option("--grid", options.grid, "Occupancy grid for navigation stacks: writes STEM.pgm and STEM.yaml").value_name("STEM");
  to_files.option("--spacing", options.spacing_m, "Of the cloud's points, m; 0: all of them").zero_or_within(0.005, 10.0).shows_default();
  to_files.option("--slice-height", options.slice_m, "In map, m").shows_default();
  to_files.option("--slice-width", options.slice_width_m, "How thick the slice is, m").positive().shows_default();
  to_files.option("--resolution", options.grid_options.resolution_m, "Of the grid, m; finer than 0.15 indoors or 0.3 outdoors, walls have holes: clouds are no denser").within(0.01, 10.0).shows_default();
  to_files.option("--base-height", options.base_height_m, "Of base above the ground, m").shows_default();
  to_files.option("--lowest", options.grid_options.lowest_m, "What is lower above the ground is driven over, m").shows_default();
  to_files.option("--highest", options.grid_options.highest_m, "What is higher is driven under, m").shows_default();
  add("optimise", "Runs the graph again, from all loops ever verified").option("--out", options.out, "Folder of the new session").required();
  app.footer("Exit: 0 done, 1 it could not be done, 2 bad usage.");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  cli::Command app;
  return cli::run_program(argc, argv, "slamd-map", "Looks into the sessions that slamd keeps of its maps, and writes them for other programs.",
                          [&](const cli::Command& made) {
                            app = made;
                            declare(made, options);
                          },
                          [&] {
                            const std::string verb = app.given_command();
                            return verb == "info" ? info(options) : verb == "export" ? export_session(options) : optimise(options);
                          });
}
