#include "tools/pose_graphs/synthetic_graph.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/LU>

#include "core/geometry/so3.hpp"

namespace slamd::pose_graphs {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

namespace {

constexpr double kStep_m = 1.0;             // between keyframes
constexpr double kRevisit_m = 4.0;          // a true loop joins keyframes so near,
constexpr double kRevisit_rad = 0.8;        // headed so alike or so opposite,
constexpr std::size_t kRevisitSteps = 50;   // and so far apart on the way
constexpr double kFalseReach_m = 3.0;       // a false loop claims to be so near
constexpr double kAlias_m = 15.0;           // places that look alike are so near each other
constexpr double kFar_m = 8.0;              // places that do not are farther apart; the smallest sphere has such
constexpr double kWrong_m = 5.0;            // a false loop is off by more than this, between places that look alike by 3 m
const Eigen::Vector3d kLever(-0.15, 0.0, 0.45);

class Source {
 public:
  explicit Source(std::uint64_t seed) : engine_(seed) {}
  double normal(double std) { return std * normal_(engine_); }
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform() * static_cast<double>(n)); }

  Vector6d normal(const Matrix6d& covariance) {
    Vector6d out;
    for (Eigen::Index k = 0; k < 6; ++k) {
      out[k] = normal(std::sqrt(covariance(k, k)));
    }
    return out;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

Matrix6d diagonal(double std_m, double std_rad) {
  Vector6d d;
  d << Eigen::Vector3d::Constant(std_m * std_m), Eigen::Vector3d::Constant(std_rad * std_rad);
  return d.asDiagonal();
}

/// The steps of the walk: turned on the spot, then ahead.
std::vector<Se3> drive(const SyntheticConfig& config, Source& source) {
  std::vector<Se3> out{Se3()};
  const auto go = [&](double yaw, double climb) {
    const Se3& last = out.back();
    const Se3 step(geometry::rotation_from_rpy({0.0, -climb, yaw}), {kStep_m, 0.0, 0.0});
    // The vehicle turns, then drives, and stands level but for the climb.
    const double heading = geometry::rpy_from_rotation(last.rotation()).z() + yaw;
    const Eigen::Matrix3d R = geometry::rotation_from_rpy({source.normal(0.01), -climb, heading});
    out.emplace_back(R, last.translation() + R * step.translation());
  };
  constexpr int kBlock = 20;
  if (config.course == Course::kSphere) {
    const double radius = std::sqrt(static_cast<double>(config.keyframes)) * kStep_m / M_PI;
    const std::size_t ring = std::max<std::size_t>(12, static_cast<std::size_t>(2.0 * M_PI * radius / kStep_m));
    while (out.size() <= config.keyframes) {
      const double turn = static_cast<double>(out.size()) / static_cast<double>(ring);
      const double latitude = M_PI * (static_cast<double>(out.size()) / static_cast<double>(config.keyframes) - 0.5);
      const double r = radius * std::max(0.2, std::cos(latitude));
      const Eigen::Vector3d p(r * std::cos(2.0 * M_PI * turn), r * std::sin(2.0 * M_PI * turn), radius * std::sin(latitude));
      out.emplace_back(geometry::rotation_from_rpy({0.0, 0.0, 2.0 * M_PI * turn + M_PI_2}), p);
    }
    out.erase(out.begin());
    const Se3 first = out.front();
    for (Se3& T : out) {
      T = first.inverse() * T;
    }
  } else if (config.course == Course::kGrid) {
    while (out.size() < config.keyframes) {
      const double turns[] = {0.0, M_PI_2, -M_PI_2};
      // Stays within ten blocks of the begin, so that it comes back.
      const Eigen::Vector3d ahead = out.back() * Eigen::Vector3d(kBlock * kStep_m, 0.0, 0.0);
      const bool out_of_town = ahead.head<2>().cwiseAbs().maxCoeff() > 100.0 * kStep_m;
      const double turn = out_of_town ? M_PI_2 : turns[source.below(3)];
      for (int k = 0; k < kBlock; ++k) {
        go(k == 0 ? turn : source.normal(0.005), 0.0);
      }
    }
  } else {
    while (out.size() < config.keyframes) {
      const int sides = 2 + static_cast<int>(source.below(4));
      const int rounds = 2 + static_cast<int>(source.below(2));
      const double hand = source.uniform() < 0.5 ? 1.0 : -1.0;
      for (int k = 0; k < 4 * rounds; ++k) {
        for (int s = 0; s < kBlock * (k % 2 == 0 ? sides : 2); ++s) {
          go(s == 0 ? hand * M_PI_2 : 0.0, 0.0);
        }
      }
      if (source.uniform() < 0.3) {
        go(M_PI, 0.0);
      }
    }
  }
  out.resize(config.keyframes);
  return out;
}

void measure_odometry(const SyntheticConfig& config, Source& source, SyntheticGraph& out) {
  Matrix6d covariance = diagonal(config.errors.step_m, config.errors.step_tilt_rad);
  covariance(5, 5) = config.errors.step_yaw_rad * config.errors.step_yaw_rad;
  out.T_odom_base.push_back(out.T_world_base.front());
  out.motion_covariance.push_back(covariance);
  for (std::size_t i = 1; i < out.T_world_base.size(); ++i) {
    const Se3 step = boxplus(out.T_world_base[i - 1].inverse() * out.T_world_base[i], source.normal(covariance));
    out.T_odom_base.push_back(out.T_odom_base.back() * step);
    out.motion_covariance.push_back(covariance);
  }
  for (const Se3& T : out.T_world_base) {
    const Eigen::Vector3d tilt(source.normal(config.errors.gravity_rad), source.normal(config.errors.gravity_rad), 0.0);
    out.gravity.push_back({geometry::so3_exp(tilt) * T.rotation().row(2).transpose(), config.errors.gravity_rad});
  }
}

void measure_fixes(const SyntheticConfig& config, Source& source, SyntheticGraph& out) {
  out.T_world_enu = {2.0, Eigen::Vector3d(40.0, -25.0, -3.0)};
  const double n = static_cast<double>(out.T_world_base.size());
  for (std::size_t i = 0; i < out.T_world_base.size(); ++i) {
    const double s = static_cast<double>(i) * kStep_m;
    if (!config.gnss || std::abs(s - 0.5 * n) < 0.5 * config.gnss_outage_s) {
      out.fixes.emplace_back();
      continue;
    }
    graph::GnssFactor fix;
    fix.p_base_antenna = kLever;
    fix.horizontal_std_m = config.errors.gnss_m;
    fix.vertical_std_m = 2.0 * config.errors.gnss_m;
    fix.p_enu = out.T_world_enu.inverse_times(out.T_world_base[i] * kLever) +
                Eigen::Vector3d(source.normal(config.errors.gnss_m), source.normal(config.errors.gnss_m),
                                source.normal(2.0 * config.errors.gnss_m));
    for (int jump = 1; jump <= 3; ++jump) {
      if (std::abs(s - 0.25 * jump * n - 40.0) < 15.0) {
        fix.p_enu.head<2>() += config.gnss_jump_m * Eigen::Vector2d(std::cos(2.0 * jump), std::sin(2.0 * jump));
      }
    }
    out.fixes.emplace_back(fix);
  }
}

bool is_revisit(const Se3& T_a_b) {
  const double yaw = std::abs(geometry::rpy_from_rotation(T_a_b.rotation()).z());
  return T_a_b.translation().norm() < kRevisit_m && (yaw < kRevisit_rad || yaw > M_PI - kRevisit_rad);
}

std::vector<SyntheticLoop> true_loops(const SyntheticConfig& config, Source& source, const SyntheticGraph& drive) {
  std::vector<std::pair<std::size_t, std::size_t>> revisits;
  for (std::size_t b = 0; b < drive.T_world_base.size(); ++b) {
    for (std::size_t a = 0; a + kRevisitSteps < b; ++a) {
      if ((drive.T_world_base[a].translation() - drive.T_world_base[b].translation()).squaredNorm() <
              kRevisit_m * kRevisit_m &&
          is_revisit(drive.T_world_base[a].inverse() * drive.T_world_base[b])) {
        revisits.emplace_back(a, b);
      }
    }
  }
  // Spread evenly over all revisits of the drive.
  std::vector<SyntheticLoop> out;
  const std::size_t wanted = std::min(config.loops, revisits.size());
  const Matrix6d covariance = diagonal(config.errors.loop_m, config.errors.loop_rad);
  for (std::size_t k = 0; k < wanted; ++k) {
    const auto [a, b] = revisits[(2 * k + 1) * revisits.size() / (2 * wanted)];
    graph::LoopCandidate candidate;
    candidate.a = static_cast<graph::KeyframeId>(a);
    candidate.b = static_cast<graph::KeyframeId>(b);
    candidate.motion = {boxplus(drive.T_world_base[a].inverse() * drive.T_world_base[b], source.normal(covariance)),
                        covariance};
    out.push_back({candidate, true});
  }
  return out;
}

/// Draws two keyframes far enough apart on the way, and near each other in the world if so asked.
std::pair<std::size_t, std::size_t> draw_pair(const SyntheticGraph& drive, Source& source, bool near) {
  constexpr std::size_t kTail = 10;  // room for a run
  const std::size_t n = drive.T_world_base.size();
  for (;;) {
    const std::size_t a = source.below(n - kRevisitSteps - kTail);
    const std::size_t b = a + kRevisitSteps + source.below(n - a - kRevisitSteps - kTail);
    const double apart_m = (drive.T_world_base[a].translation() - drive.T_world_base[b].translation()).norm();
    if (near ? apart_m < kAlias_m : apart_m > kFar_m) {
      return {a, b};
    }
  }
}

/// What a false loop claims: of places that look alike the truth but for a shift, of others anything near.
Se3 false_claim(const Se3& T_a_b, Source& source, bool near) {
  if (near) {
    const double direction = 2.0 * M_PI * source.uniform();
    const double shift = 3.0 + 5.0 * source.uniform();
    return {T_a_b.rotation(), T_a_b.translation() + shift * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0)};
  }
  for (;;) {
    const double yaw = (2.0 * source.uniform() - 1.0) * M_PI;
    const double x = source.normal(kFalseReach_m);
    const double y = source.normal(kFalseReach_m);
    const Eigen::Vector3d p(x, y, source.normal(0.2));
    if ((p - T_a_b.translation()).norm() > kWrong_m) {
      return {geometry::rotation_from_rpy({0.0, 0.0, yaw}), p};
    }
  }
}

/// In a run, several in a row make the same mistake.
void add_false_loops(const SyntheticConfig& config, Source& source, SyntheticGraph& out) {
  const auto wanted = static_cast<std::size_t>(config.false_share / (1.0 - config.false_share) *
                                               static_cast<double>(out.loops.size()));
  const Matrix6d covariance = diagonal(config.errors.loop_m, config.errors.loop_rad);
  for (std::size_t made = 0; made < wanted;) {
    const bool run = source.uniform() < config.false_runs;
    const bool near = source.uniform() < config.false_near;
    const std::size_t length = run ? std::min<std::size_t>(3 + source.below(3), wanted - made) : 1;
    const auto [a, b] = draw_pair(out, source, near);
    const Se3 claimed = false_claim(out.T_world_base[a].inverse() * out.T_world_base[b], source, near);
    for (std::size_t k = 0; k < length; ++k) {
      graph::LoopCandidate candidate;
      candidate.a = static_cast<graph::KeyframeId>(a + k);
      candidate.b = static_cast<graph::KeyframeId>(b + k);
      const Se3 same_mistake = (out.T_world_base[a].inverse() * out.T_world_base[a + k]).inverse() * claimed *
                               (out.T_world_base[b].inverse() * out.T_world_base[b + k]);
      candidate.motion = {boxplus(same_mistake, source.normal(covariance)), covariance};
      out.loops.push_back({candidate, false});
    }
    made += length;
  }
  std::stable_sort(out.loops.begin(), out.loops.end(), [](const SyntheticLoop& x, const SyntheticLoop& y) {
    return x.candidate.b < y.candidate.b;
  });
}

}  // namespace

SyntheticGraph make_graph(const SyntheticConfig& config) {
  Source source(config.seed);
  SyntheticGraph out;
  out.T_world_base = drive(config, source);
  measure_odometry(config, source, out);
  measure_fixes(config, source, out);
  out.loops = true_loops(config, source, out);
  add_false_loops(config, source, out);
  return out;
}

double position_error(const SyntheticGraph& truth, const graph::PoseGraph& estimate) {
  const Se3 T_map_world = estimate.node(0).T_map_base * truth.T_world_base[0].inverse();
  double sum = 0.0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Se3& T_world_base = truth.T_world_base[estimate.node(i).id];
    sum += (estimate.node(i).T_map_base.translation() - T_map_world * T_world_base.translation()).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(estimate.size()));
}

EarthError earth_error(const SyntheticGraph& truth, const graph::PoseGraph& estimate) {
  EarthError out;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Se3& T_world_base = truth.T_world_base[estimate.node(i).id];
    const double error = (estimate.alignment()->inverse_times(estimate.node(i).T_map_base.translation()) -
                          truth.T_world_enu.inverse_times(T_world_base.translation()))
                             .norm();
    out.rms_m += error * error / static_cast<double>(estimate.size());
    out.max_m = std::max(out.max_m, error);
  }
  out.rms_m = std::sqrt(out.rms_m);
  return out;
}

void fill(const SyntheticGraph& from, graph::PoseGraph& graph, bool with_gnss) {
  for (std::size_t i = 0; i < from.T_world_base.size(); ++i) {
    graph::BetweenFactor odometry;
    if (i > 0) {
      odometry = {from.T_odom_base[i - 1].inverse() * from.T_odom_base[i], from.motion_covariance[i].inverse()};
    }
    graph.add_keyframe(static_cast<graph::KeyframeId>(i), from.T_odom_base[i], odometry);
    graph.set_gravity(i, from.gravity[i]);
    if (with_gnss && from.fixes[i]) {
      graph.set_fix(i, *from.fixes[i]);
    }
  }
  graph.add_prior(0, {from.T_odom_base[0], graph::anchor_information()});
  graph::LoopId id = 0;
  for (const SyntheticLoop& loop : from.loops) {
    graph.add_loop({id++, loop.candidate.a, loop.candidate.b,
                    {loop.candidate.motion.T_a_b, loop.candidate.motion.covariance.inverse()}, 1.0, true});
  }
}

}  // namespace slamd::pose_graphs
