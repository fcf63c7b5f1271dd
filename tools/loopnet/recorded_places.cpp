#include "tools/loopnet/recorded_places.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/loop/polar_image.hpp"
#include "drivers/clouds/conversion.hpp"
#include "drivers/clouds/file_list.hpp"
#include "drivers/clouds/point_folder.hpp"
#include "drivers/recording/packet.hpp"
#include "tools/loopnet/scan_context.hpp"
#include "tools/simulate/noise.hpp"

namespace slamd::loopnet {

namespace {

using recording::RecordingError;

std::vector<geometry::Se3> read_rows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<geometry::Se3> poses;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream numbers(line);
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> row;
    for (int i = 0; i < 12; ++i) {
      if (!(numbers >> row.data()[i])) {
        throw RecordingError(path, "row " + std::to_string(poses.size() + 1) + " has not 12 numbers");
      }
    }
    const Eigen::Matrix3d R = row.leftCols<3>();
    const Eigen::Vector3d p = row.col(3);
    poses.emplace_back(Eigen::Quaterniond(R), p);  // normalised: rows are rounded
  }
  if (poses.empty()) {
    throw RecordingError(path, "no poses");
  }
  return poses;
}

std::size_t row_of(const std::filesystem::path& cloud, std::size_t rows) {
  const std::string stem = cloud.stem().string();
  const std::size_t row =
      stem.find_first_not_of("0123456789") == std::string::npos ? std::stoul(stem) : rows;
  if (row >= rows) {
    throw RecordingError(cloud, "no pose: the number in its name is no row");
  }
  return row;
}

std::vector<Eigen::Vector3f> read_points(const std::filesystem::path& path) {
  std::vector<std::byte> bytes;
  clouds::RawCloud raw;
  clouds::Cloud cloud;
  clouds::CloudConverter converter(false);
  std::optional<clouds::CloudRefusal> refusal = clouds::read_cloud_file(path, bytes, raw);
  refusal = refusal ? refusal : converter.convert(raw, cloud);
  if (refusal) {
    throw RecordingError(path, std::string(clouds::name_of(*refusal)));
  }
  std::vector<Eigen::Vector3f> points;
  for (const sensor::Point& point : cloud.points) {
    points.emplace_back(point.x_m, point.y_m, point.z_m);
  }
  return points;
}

struct Frame {
  geometry::Se3 T_world_lidar;
  std::vector<Eigen::Vector3f> points;
};

}  // namespace

std::size_t add_recorded_places(const RecordedPlaces& places, PlaceFile& file) {
  const std::vector<geometry::Se3> poses = read_rows(places.poses);
  const simulate::Noise noise(places.seed, 950);
  std::vector<Frame> frames;
  std::vector<Eigen::Vector3f> points_world;
  Eigen::Vector3d last = Eigen::Vector3d::Constant(1e9);
  loop::PolarImager imager;
  loop::PolarImage image;
  std::size_t count = 0;
  for (const clouds::CloudFile& cloud : clouds::list_clouds(places.clouds).files) {
    frames.push_back({poses[row_of(cloud.path, poses.size())], read_points(cloud.path)});
    const geometry::Se3& T_world_lidar = frames.back().T_world_lidar;
    if (frames.size() < places.submap || (T_world_lidar.translation() - last).norm() < places.apart_m) {
      continue;
    }
    last = T_world_lidar.translation();
    points_world.clear();
    for (std::size_t i = frames.size() - places.submap; i < frames.size(); ++i) {
      for (const Eigen::Vector3f& point : frames[i].points) {
        points_world.push_back((frames[i].T_world_lidar * point.cast<double>()).cast<float>());
      }
    }
    const double turn_rad = places.turn ? noise.uniform(count, -M_PI, M_PI) : 0.0;
    geometry::Se3 T_world_level = loop::level_of(T_world_lidar);
    T_world_level.rotation() *= Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    imager.clear();
    imager.add(T_world_level.inverse(), points_world);
    imager.finish(image);
    const Eigen::Vector3d& p = T_world_level.translation();
    const Eigen::Matrix3d& R = T_world_level.rotation();
    file.add({places.world, static_cast<float>(count), -1.0F, places.sensor, places.indoor ? 1.0F : 0.0F,
              static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
              static_cast<float>(std::atan2(R(1, 0), R(0, 0)))},
             image, scan_context_of(T_world_level.inverse(), points_world));
    ++count;
  }
  return count;
}

}  // namespace slamd::loopnet
