#include "tools/simulate/mover.hpp"

#include <cmath>

namespace slamd::simulate {

MoverPlace place_of(const Mover& mover, double t_s) {
  const auto count = static_cast<double>(mover.path.size());
  double place = std::fmod((mover.start_m + mover.speed_mps * t_s) / Mover::kStep_m, count);
  place = place < 0.0 ? place + count : place;
  const auto i = std::min(static_cast<std::size_t>(place), mover.path.size() - 1);
  const std::size_t next = (i + 1) % mover.path.size();
  const double share = place - static_cast<double>(i);
  const Eigen::Vector2d d = mover.path[next] - mover.path[i];
  const Eigen::Vector2d p = mover.path[i] + share * d;
  return {{p.x(), p.y(), (1.0 - share) * mover.ground_m[i] + share * mover.ground_m[next]}, std::atan2(d.y(), d.x())};
}

std::vector<Eigen::Vector2d> sampled(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Eigen::Vector2d> path;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d from = corners[i];
    const Eigen::Vector2d to = corners[(i + 1) % corners.size()];
    const int pieces = std::max(1, static_cast<int>((to - from).norm() / Mover::kStep_m));
    for (int k = 0; k < pieces; ++k) {
      path.push_back(from + (to - from) * (static_cast<double>(k) / pieces));
    }
  }
  return path;
}

std::vector<OrientedBox> car_boxes() {
  return {{{0.0, 0.0, 0.6}, {2.1, 0.86, 0.38}, 0.0, 0.6F}, {{-0.2, 0.0, 1.22}, {1.1, 0.74, 0.3}, 0.0, 0.3F}};
}

std::vector<OrientedBox> person_boxes() {
  return {{{0.0, 0.0, 0.45}, {0.16, 0.18, 0.42}, 0.0, 0.35F},
          {{0.0, 0.0, 1.15}, {0.14, 0.24, 0.32}, 0.0, 0.45F},
          {{0.02, 0.0, 1.63}, {0.1, 0.09, 0.13}, 0.0, 0.55F}};
}

}  // namespace slamd::simulate
