#include "tools/loopnet/place_visit.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/base/units.hpp"
#include "tools/simulate/beam.hpp"

namespace slamd::loopnet {

namespace {

constexpr double kSettled_s = 5000.0;  // moments of visits lie within: movers are anywhere

Eigen::Matrix3d attitude(double yaw_rad, double pitch_rad, double roll_rad) {
  return (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

Visitor::Visitor(const PlaceWorld& place_world, const VisitorSettings& settings, std::uint64_t seed)
    : place_world_(place_world),
      settings_(settings),
      noise_(seed, 900),
      sensor_(settings.sensor, simulate::Noise(seed, 901)),
      lidar_m_(uniform(0.0, 0.4)),
      noise_m_(uniform(0.01, 0.03)),
      drop_out_(uniform(0.0, 0.15)) {
  const Eigen::Vector2d heights = sensor_.heights_m();
  base_m_ = uniform(heights.x(), heights.y()) - lidar_m_;
  for (const std::vector<Eigen::Vector2d>& lane : place_world.lanes) {
    for (std::size_t i = 0; i + 1 < lane.size(); ++i) {
      lines_.push_back({lane[i], lane[i + 1]});
    }
  }
}

std::vector<Visit> Visitor::visit(std::size_t places, std::size_t visits_each) {
  std::vector<double> ends;  // of the lines, one behind the other
  for (const Line& line : lines_) {
    ends.push_back((ends.empty() ? 0.0 : ends.back()) + (line.to - line.from).norm());
  }
  const double beside_m = place_world_.indoor ? 1.5 : 4.0;
  std::vector<Visit> visits;
  for (std::size_t attempt = 0, place = 0; place < places && attempt < 10 * places; ++attempt) {
    const double way_m = uniform(0.0, ends.back());
    const auto line = static_cast<std::size_t>(std::lower_bound(ends.begin(), ends.end(), way_m) - ends.begin());
    const double along_m = way_m - (line > 0 ? ends[line - 1] : 0.0);
    std::vector<Visit> here;
    for (std::size_t trial = 0; here.size() < visits_each && trial < 4 * visits_each; ++trial) {
      Visit visit;
      visit.place = place;
      if (find(lines_[line], along_m + uniform(-beside_m, beside_m), visit)) {
        here.push_back(visit);
      }
    }
    if (here.size() == visits_each) {
      for (Visit& visit : here) {
        see(visit);
      }
      visits.insert(visits.end(), here.begin(), here.end());
      ++place;
    }
  }
  return visits;
}

/// Along the lane, against it, or anywhere; an Avia sees again only what it looks at again.
double Visitor::heading_for(double lane_rad) {
  const double draw = uniform(0.0, 1.0);
  if (settings_.sensor == PlaceSensor::Kind::kAvia) {
    return lane_rad + (draw < 0.75 ? uniform(-22.0, 22.0) * kDegree : (draw < 0.85 ? M_PI : uniform(-M_PI, M_PI)));
  }
  return lane_rad + (draw < 0.7 ? (draw < 0.35 ? 0.0 : M_PI) + 5.0 * kDegree * normal() : uniform(-M_PI, M_PI));
}

bool Visitor::find(const Line& line, double along_m, Visit& visit) {
  const Eigen::Vector2d ahead = (line.to - line.from).normalized();
  const double aside_m = place_world_.indoor ? uniform(-0.3, 0.3) : uniform(-1.8, 1.8);
  const Eigen::Vector2d p = line.from + along_m * ahead + aside_m * Eigen::Vector2d(-ahead.y(), ahead.x());
  const Eigen::Vector2d& extent_m = place_world_.world.extent_m();
  if (p.x() < 1.0 || p.y() < 1.0 || p.x() > extent_m.x() - 1.0 || p.y() > extent_m.y() - 1.0) {
    return false;
  }
  const Eigen::Vector3d origin(p.x(), p.y(), place_world_.floor(p.x(), p.y()) + base_m_);
  for (int i = 0; i < 12; ++i) {
    if (clearance_m(origin, i * M_PI / 6.0) < 0.45) {
      return false;  // in a wall, or too near to one
    }
  }
  visit.heading_rad = std::remainder(heading_for(std::atan2(ahead.y(), ahead.x())), 2.0 * M_PI);
  visit.T_world_level = {attitude(visit.heading_rad, 0.0, 0.0), origin};
  return true;
}

double Visitor::clearance_m(const Eigen::Vector3d& origin, double heading_rad) const {
  simulate::Hit hit;
  const Eigen::Vector3d direction(std::cos(heading_rad), std::sin(heading_rad), 0.0);
  return place_world_.world.cast(origin, direction, 20.0, 1, hit) ? hit.range_m : 20.0;
}

Visitor::Plan Visitor::plan() {
  const bool avia = settings_.sensor == PlaceSensor::Kind::kAvia;
  const double draw = uniform(0.0, 1.0);
  Plan plan;
  if (settings_.submaps == SubmapKind::kMapped) {
    plan.scans = 10;
    plan.step_m = uniform(0.05, 0.3);
    plan.rays = 2'400;
    plan.behind = 9.0;
    return plan;
  }
  if (avia) {
    plan.scans = 10 + static_cast<std::size_t>(3.0 * draw);
    plan.step_m = uniform(0.1, 0.6);
    plan.rays = 14'000 / plan.scans;
  } else {
    const bool several = settings_.submaps == SubmapKind::kAny && draw < 0.5;
    plan.scans = several ? 3 + static_cast<std::size_t>(10.0 * draw) : 1;
    plan.step_m = uniform(0.2, place_world_.indoor ? 0.6 : 1.2);
    const std::size_t all = settings_.sensor == PlaceSensor::Kind::kVlp16 ? 9'600 : 16'000;
    plan.rays = (several ? 3 * all / 2 : all) / plan.scans;
  }
  plan.behind = uniform(0.4, 1.0) * static_cast<double>(plan.scans - 1);
  return plan;
}

void Visitor::see(Visit& visit) {
  const Plan submap = plan();
  const Eigen::Vector3d& origin = visit.T_world_level.translation();
  const double before_m = std::min(clearance_m(origin, visit.heading_rad + M_PI) - 0.5, 30.0);
  const double after_m = std::min(clearance_m(origin, visit.heading_rad) - 0.5, 30.0);
  const double t_s = uniform(0.0, kSettled_s);
  points_world_.clear();
  for (std::size_t i = 0; i < submap.scans; ++i) {
    const double along_m = std::clamp((static_cast<double>(i) - submap.behind) * submap.step_m, -before_m, after_m);
    const double turn_rad = submap.scans == 1 ? 0.0 : 3.0 * kDegree * normal();
    const Eigen::Vector3d ahead(std::cos(visit.heading_rad), std::sin(visit.heading_rad), 0.0);
    const Eigen::Vector3d p = origin + along_m * ahead;
    const Eigen::Vector3d there(p.x(), p.y(), place_world_.floor(p.x(), p.y()) + base_m_);
    scan({attitude(visit.heading_rad + turn_rad, 1.4 * kDegree * normal(), 1.4 * kDegree * normal()), there}, submap.rays,
         t_s + 0.5 * static_cast<double>(i));
  }
  thin_submap();
  // The attitude by which a submap is levelled is a little wrong.
  const geometry::Se3 T_world_believed(
      visit.T_world_level.rotation() * attitude(0.0, 0.3 * kDegree * normal(), 0.3 * kDegree * normal()), origin);
  imager_.clear();
  imager_.add(T_world_believed.inverse(), points_world_);
  imager_.finish(visit.image);
  visit.context = scan_context_of(T_world_believed.inverse(), points_world_);
}

void Visitor::scan(const geometry::Se3& T_world_base, std::size_t rays, double t_s) {
  simulate::RangeErrors errors;
  errors.noise_m = noise_m_;
  const simulate::Beam beam(place_world_.world, errors, noise_);
  sensor_.look(rays, ++draws_, rays_);
  const Eigen::Vector3d origin = T_world_base * Eigen::Vector3d(0.0, 0.0, lidar_m_);
  for (const Eigen::Vector3d& ray : rays_) {
    const std::uint64_t shot = ++shots_;
    if (noise_.uniform(3'000'000'000 + shot) < drop_out_) {
      continue;
    }
    const Eigen::Vector3d direction = T_world_base.rotation() * ray;
    const simulate::Echoes echoes = beam.shoot(origin, direction, t_s, shot, 0.0);
    if (const simulate::Echo* echo = echoes.strongest()) {
      points_world_.emplace_back((origin + echo->range_m * direction).cast<float>());
    }
  }
}

void Visitor::thin_submap() {
  constexpr std::size_t kMapped = 4'096;
  constexpr double kGrowth = 1.26;
  if (settings_.submaps == SubmapKind::kMapped) {
    double cell_m = place_world_.indoor ? 0.15 : 0.30;
    thin(cell_m);
    while (points_world_.size() > kMapped) {
      cell_m *= kGrowth;
      thin(cell_m);
    }
  } else if (settings_.submaps == SubmapKind::kAny && uniform(0.0, 1.0) < 0.5) {
    thin(std::exp(uniform(std::log(0.05), std::log(0.5))));
  }
}

/// Keeps one point in each cell.
void Visitor::thin(double cell_m) {
  std::unordered_set<std::uint64_t> taken;
  std::erase_if(points_world_, [&](const Eigen::Vector3f& p) {
    const auto part = [&](float v) {
      return static_cast<std::uint64_t>(std::floor(static_cast<double>(v) / cell_m) + 100'000.0) & 0x1FFFFF;
    };
    return !taken.insert(part(p.x()) << 42 | part(p.y()) << 21 | part(p.z())).second;
  });
}

}  // namespace slamd::loopnet
