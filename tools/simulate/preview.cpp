#include "tools/simulate/preview.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace slamd::simulate {

namespace {

constexpr std::size_t kHeights = 60;
constexpr std::size_t kShades = 3;
constexpr std::size_t kGreys = 60;
constexpr std::uint8_t kSky = 0;
constexpr std::uint8_t kPath = 1;
constexpr std::uint8_t kScan = 2;
constexpr std::uint8_t kDeep = 3;  // water, pits
constexpr std::uint8_t kFirstHeight = 4;
constexpr std::uint8_t kFirstGrey = kFirstHeight + kHeights * kShades;
constexpr double kEyes_m = 1.6;
constexpr double kNear_m = 1.5;  // what is nearer hides the rest
constexpr int kEdgeCounts = 3;  // as much as so many rays on surfaces
constexpr double kHeadroom_m = 2.2;  // what lies higher is roof
constexpr std::uint64_t kRays = 1ULL << 40;  // numbers that no LiDAR uses

std::vector<plot::Rgb> palette() {
  std::vector<plot::Rgb> colours{{24, 30, 44}, {240, 60, 50}, {255, 255, 255}, {28, 74, 128}};
  for (std::size_t h = 0; h < kHeights; ++h) {
    for (std::size_t s = 0; s < kShades; ++s) {
      const double light = 0.45 + 0.275 * static_cast<double>(s);
      const plot::Rgb c = plot::height_colour(static_cast<double>(h) / (kHeights - 1));
      colours.push_back({static_cast<std::uint8_t>(light * c.r), static_cast<std::uint8_t>(light * c.g),
                         static_cast<std::uint8_t>(light * c.b)});
    }
  }
  for (std::size_t g = 0; g < kGreys; ++g) {
    const auto v = static_cast<std::uint8_t>(30 + 215 * g / (kGreys - 1));
    colours.push_back({v, v, static_cast<std::uint8_t>(std::min(255, v + 6))});
  }
  return colours;
}

/// A part of the picture, seen from above.
struct Plan {
  std::size_t width = 0;
  std::size_t height = 0;
  double pixel_m = 1.0;

  bool place(const Eigen::Vector3d& p, std::size_t& x, std::size_t& y) const {
    const double px = p.x() / pixel_m;
    const double py = static_cast<double>(height) - 1.0 - p.y() / pixel_m;
    if (!(px >= 0.0 && py >= 0.0 && px < static_cast<double>(width) && py < static_cast<double>(height))) {
      return false;
    }
    x = static_cast<std::size_t>(px);
    y = static_cast<std::size_t>(py);
    return true;
  }
};

bool is_roofed(const Scene& scene, double t_s) {
  Hit hit;
  return scene.world().cast(scene.motion().pose_at(t_s).translation(), Eigen::Vector3d::UnitZ(), 15.0, kRays, hit, t_s);
}

/// Tells whether a wall stands in a pixel: roofs are off, but walls reach up to them and show no top.
bool is_walled(const World& world, const Eigen::Vector3d& p, double pixel_m, double t_s) {
  for (const Eigen::Vector3d& d :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0)}) {
    Hit hit;
    if (world.cast(p, d, pixel_m, kRays, hit, t_s)) {
      return true;
    }
  }
  return false;
}

void draw_plan(const Scene& scene, const Plan& plan, double t_s, plot::IndexedImage& image) {
  const bool roofed = is_roofed(scene, t_s);
  for (std::size_t y = 0; y < plan.height; ++y) {
    for (std::size_t x = 0; x < plan.width; ++x) {
      const double wx = (static_cast<double>(x) + 0.5) * plan.pixel_m;
      const double wy = (static_cast<double>(plan.height - y) - 0.5) * plan.pixel_m;
      const double floor = scene.route().floor(wx, wy);
      const double top = floor + (roofed ? kHeadroom_m : 60.0);
      Hit hit;
      if (roofed && is_walled(scene.world(), {wx, wy, floor + 1.5}, plan.pixel_m, t_s)) {
        image.pixels[y * image.width + x] = kFirstHeight + (kHeights - 1) * kShades + 2;
        continue;
      }
      if (!scene.world().cast({wx, wy, top}, -Eigen::Vector3d::UnitZ(), 200.0, kRays + y * plan.width + x, hit, t_s)) {
        continue;
      }
      // Colour by height over the floor, on a scale that keeps kerbs apart; leaning surfaces are darker.
      const double above = std::max(0.0, top - hit.range_m - floor);
      if (top - hit.range_m - floor < -1.0) {
        image.pixels[y * image.width + x] = kDeep;
        continue;
      }
      const double share = std::min(1.0, std::log1p(4.0 * above) / std::log1p(4.0 * 14.0));
      const auto h = static_cast<std::size_t>(std::lround(share * (kHeights - 1)));
      const std::size_t s = hit.cos_incidence > 0.9995 ? 2 : hit.cos_incidence > 0.99 ? 1 : 0;
      image.pixels[y * image.width + x] = static_cast<std::uint8_t>(kFirstHeight + h * kShades + s);
    }
  }
}

void dot(const Plan& plan, const Eigen::Vector3d& p, std::uint8_t colour, int size, plot::IndexedImage& image) {
  std::size_t x = 0;
  std::size_t y = 0;
  if (!plan.place(p, x, y)) {
    return;
  }
  for (std::size_t dy = 0; dy < static_cast<std::size_t>(size) && y + dy < plan.height; ++dy) {
    for (std::size_t dx = 0; dx < static_cast<std::size_t>(size) && x + dx < plan.width; ++dx) {
      image.pixels[(y + dy) * image.width + x + dx] = colour;
    }
  }
}

/// The directions of one scan.  Frames: lidar.
std::vector<Eigen::Vector3d> scan_directions(const Scene& scene, double t_s) {
  std::vector<Eigen::Vector3d> directions;
  if (scene.spinning() == nullptr) {
    const Risley avia({0.3, 1.2, 2.1});
    for (int i = 0; i < 20'000; ++i) {
      directions.push_back(scene.avia() != nullptr ? avia.direction(t_s + i / 240e3, i % 6)
                                                   : scene.mid360()->direction(t_s + i / 200e3, i % 4));
    }
    return directions;
  }
  const SpinningKind kind = scene.drive().lidar == LidarKind::kVlp16 ? SpinningKind::kVlp16
                            : scene.drive().lidar == LidarKind::kVlp32c ? SpinningKind::kVlp32c
                                                                        : SpinningKind::kHdl32e;
  const SpinningModel& model = model_of(kind);
  for (int column = 0; column < 900; ++column) {
    for (std::size_t laser = 0; laser < static_cast<std::size_t>(model.lasers); ++laser) {
      const double alpha = 2.0 * M_PI * column / 900.0;
      const double omega = model.elevation_deg[laser] * M_PI / 180.0;
      directions.emplace_back(std::cos(omega) * std::cos(alpha), -std::cos(omega) * std::sin(alpha), std::sin(omega));
    }
  }
  return directions;
}

void draw_scan(const Scene& scene, const Plan& plan, double t_s, plot::IndexedImage& image) {
  const geometry::Se3 T_world_lidar = scene.motion().pose_at(t_s) * scene.mounting().T_base_lidar;
  std::uint64_t ray = kRays / 2;
  for (const Eigen::Vector3d& d_lidar : scan_directions(scene, t_s)) {
    const Eigen::Vector3d d = T_world_lidar.rotation() * d_lidar;
    Hit hit;
    if (scene.world().cast(T_world_lidar.translation(), d, 90.0, ++ray, hit, t_s)) {
      dot(plan, T_world_lidar.translation() + hit.range_m * d, kScan, 1, image);
    }
  }
}

/// Where somebody is who walks behind the vehicle.
geometry::Se3 behind(const Scene& scene, double t_s) { return scene.motion().pose_at(std::max(0.0, t_s - 2.0)); }

/// What somebody sees who walks behind the vehicle.
void draw_view(const Scene& scene, std::size_t top, double t_s, plot::IndexedImage& image) {
  const geometry::Se3 T = behind(scene, t_s);
  const Eigen::Vector3d ahead = (T.rotation().col(0) - 0.1 * Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d up = right.cross(ahead);
  const double floor = scene.route().floor(T.translation().x(), T.translation().y());
  const Eigen::Vector3d eye(T.translation().x(), T.translation().y(), floor + kEyes_m);
  const double height = static_cast<double>(image.height - top);
  for (std::size_t y = top; y < image.height; ++y) {
    for (std::size_t x = 0; x < image.width; ++x) {
      const double u = 2.0 * static_cast<double>(x) / static_cast<double>(image.width) - 1.0;
      const double v = (0.5 * height - static_cast<double>(y - top)) / (0.5 * static_cast<double>(image.width));
      const Eigen::Vector3d d = (ahead + u * right + v * up).normalized();
      Hit hit;
      if (!scene.world().cast(eye, d, 300.0, kRays + y * image.width + x, hit, t_s)) {
        continue;
      }
      const double light = (0.35 + 0.65 * hit.cos_incidence) * std::sqrt(static_cast<double>(hit.reflectivity)) *
                           (0.35 + 0.65 * std::exp(-hit.range_m / 70.0));
      const auto grey = static_cast<std::size_t>(std::clamp(light * 1.15, 0.0, 1.0) * (kGreys - 1));
      image.pixels[y * image.width + x] = static_cast<std::uint8_t>(kFirstGrey + grey);
    }
  }
}

/// The moment at which most is to be seen ahead: surfaces that are not too near, and edges.
double best_moment_s(const Scene& scene) {
  double best_s = 0.0;
  int most = -1;
  for (int i = 1; i < 20; ++i) {
    const double t_s = scene.motion().duration_s() * i / 20.0;
    const geometry::Se3 T = behind(scene, t_s);
    int seen = 0;
    double beside_m = 0.0;
    for (int ray = 0; ray < 400; ++ray) {
      const double azimuth = (ray % 40 - 19.5) / 19.5 * 0.75;
      const double elevation = (ray / 40 - 1) * 0.04;
      Hit hit;
      const Eigen::Vector3d d =
          T.rotation() * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                         std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const bool met = scene.world().cast(T.translation() + Eigen::Vector3d(0.0, 0.0, 1.0), d, 70.0, kRays, hit, t_s);
      const double range_m = met ? hit.range_m : 70.0;
      seen += met && hit.range_m > kNear_m ? 1 : 0;
      seen += ray % 40 != 0 && std::abs(range_m - beside_m) > 0.7 ? kEdgeCounts : 0;
      beside_m = range_m;
    }
    if (seen > most) {
      most = seen;
      best_s = t_s;
    }
  }
  return best_s;
}

}  // namespace

plot::IndexedImage preview_of(const Scene& scene, std::size_t width) {
  const Eigen::Vector2d& extent = scene.world().extent_m();
  Plan plan;
  plan.width = width;
  plan.pixel_m = extent.x() / static_cast<double>(width);
  plan.height = static_cast<std::size_t>(extent.y() / plan.pixel_m);
  plot::IndexedImage image;
  image.width = width;
  image.height = plan.height + 6 + width / 2;
  image.palette = palette();
  image.pixels.assign(image.width * image.height, kSky);
  const double moment_s = best_moment_s(scene);
  draw_plan(scene, plan, moment_s, image);
  draw_scan(scene, plan, moment_s, image);
  for (double t = 0.0; t < scene.motion().duration_s(); t += 0.05) {
    dot(plan, scene.motion().pose_at(t).translation(), kPath, 2, image);
  }
  draw_view(scene, plan.height + 6, moment_s, image);
  return image;
}

}  // namespace slamd::simulate
