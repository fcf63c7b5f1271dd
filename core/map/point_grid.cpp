#include "core/map/point_grid.hpp"

#include <algorithm>
#include <utility>

#include "core/base/fixed_vector.hpp"

namespace slamd::map {

namespace {

constexpr std::uint32_t kNone = CellTable<PointCell>::kNone;
constexpr std::size_t kAround = 27;
constexpr std::size_t kMiddle = 13;

/// What a step along x, y or z adds to a neighbour's number.
constexpr std::array<std::int32_t, 3> kNumberSteps = {9, 3, 1};

/// A neighbour's number among the 27: (x, y, z) of −1, 0, 1. The opposite one's is 26 minus it.
constexpr std::size_t number_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  return static_cast<std::size_t>((x + 1) * 9 + (y + 1) * 3 + (z + 1));
}

struct Step {
  std::int32_t x, y, z;
};

constexpr std::array<Step, kAround> all_steps() {
  std::array<Step, kAround> steps{};
  for (std::int32_t x = -1; x <= 1; ++x) {
    for (std::int32_t y = -1; y <= 1; ++y) {
      for (std::int32_t z = -1; z <= 1; ++z) {
        steps[number_of(x, y, z)] = {x, y, z};
      }
    }
  }
  return steps;
}

constexpr std::array<Step, kAround> kSteps = all_steps();

}  // namespace

PointGrid::PointGrid(float cell_m, std::size_t max_cells)
    : cell_m_(cell_m),
      inverse_cell_(1.0F / cell_m),
      search_(fastest_cell_search()),
      cells_(max_cells),
      surroundings_(max_cells) {
  surroundings_.resize(max_cells);
}

void PointGrid::clear() { cells_.clear(); }

void PointGrid::forget_before(float path_m) {
  cells_.forget_before(path_m, [this](std::uint32_t place) { withdraw(place); });
}

void PointGrid::insert(std::span<const Eigen::Vector3f> points_odom, float path_m) {
  for (std::size_t i = 0; i < points_odom.size(); ++i) {
    if (i + kAhead < points_odom.size()) {
      prefetch(points_odom[i + kAhead]);
    }
    insert(points_odom[i], path_m);
  }
}

void PointGrid::insert(const Eigen::Vector3f& p_odom, float path_m) {
  const auto touched = cells_.touch(geometry::key_of(p_odom, inverse_cell_), path_m,
                                    [this](std::uint32_t place) { withdraw(place); });
  if (touched.created) {
    introduce(touched.place, p_odom);
  }
  PointCell& cell = cells_[touched.place];
  std::uint32_t sub_cube = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float fraction =
        p_odom[axis] * inverse_cell_ - static_cast<float>(geometry::cell_index(p_odom[axis], inverse_cell_));
    const auto division = std::min(
        PointCell::kDivisions - 1, static_cast<std::uint32_t>(fraction * static_cast<float>(PointCell::kDivisions)));
    sub_cube = sub_cube * PointCell::kDivisions + division;
  }
  const std::uint64_t bit = std::uint64_t{1} << sub_cube;
  if ((cell.occupied & bit) == 0) {
    cell.occupied |= bit;
    cell.add(p_odom);
  }
}

/// Makes a new cell and its neighbours known to one another.
void PointGrid::introduce(std::uint32_t place, const Eigen::Vector3f& p_odom) {
  const std::int32_t x = geometry::cell_index(p_odom.x(), inverse_cell_);
  const std::int32_t y = geometry::cell_index(p_odom.y(), inverse_cell_);
  const std::int32_t z = geometry::cell_index(p_odom.z(), inverse_cell_);
  for (std::size_t i = 0; i < kAround; ++i) {
    const std::uint32_t other =
        i == kMiddle ? place : cells_.place_of(geometry::pack(x + kSteps[i].x, y + kSteps[i].y, z + kSteps[i].z));
    surroundings_[place].places[i] = other;
    if (other != kNone) {
      surroundings_[other].places[kAround - 1 - i] = place;
    }
  }
}

/// Makes the neighbours forget a cell that is about to go.
void PointGrid::withdraw(std::uint32_t place) {
  for (std::size_t i = 0; i < kAround; ++i) {
    const std::uint32_t other = surroundings_[place].places[i];
    if (other != kNone) {
      surroundings_[other].places[kAround - 1 - i] = kNone;
    }
  }
}

Neighbours PointGrid::nearest(const Eigen::Vector3f& query_odom, float radius_m) const {
  const float radius_sq = radius_m * radius_m;
  const std::int32_t cell[3] = {geometry::cell_index(query_odom.x(), inverse_cell_),
                                geometry::cell_index(query_odom.y(), inverse_cell_),
                                geometry::cell_index(query_odom.z(), inverse_cell_)};
  const std::uint32_t middle = cells_.place_of(geometry::pack(cell[0], cell[1], cell[2]));
  const auto place_at = [&](std::size_t i) {
    return middle != kNone ? surroundings_[middle].places[i]
                           : cells_.place_of(geometry::pack(cell[0] + kSteps[i].x, cell[1] + kSteps[i].y,
                                                            cell[2] + kSteps[i].z));
  };

  // Squared distance to the layers of cells on both sides of the query's, by axis and step.
  float gap_sq[3][3];
  struct Side {
    float gap_sq;
    std::int32_t number_step;
  };
  std::array<Side, 3> near;  // of each axis, the nearest first
  float least_far_sq = radius_sq;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float fraction = query_odom[static_cast<Eigen::Index>(axis)] * inverse_cell_ - static_cast<float>(cell[axis]);
    const float below = cell_m_ * fraction;
    const float above = cell_m_ * (1.0F - fraction);
    gap_sq[axis][0] = below * below;
    gap_sq[axis][1] = 0.0F;
    gap_sq[axis][2] = above * above;
    const bool down = fraction < 0.5F;
    near[axis] = {gap_sq[axis][down ? 0 : 2], down ? -kNumberSteps[axis] : kNumberSteps[axis]};
    least_far_sq = std::min(least_far_sq, gap_sq[axis][down ? 2 : 0]);
  }
  const auto sort_two = [&](std::size_t a, std::size_t b) {
    if (near[b].gap_sq < near[a].gap_sq) {
      std::swap(near[a], near[b]);
    }
  };
  sort_two(0, 1);
  sort_two(1, 2);
  sort_two(0, 1);

  Nearest best(radius_sq);
  FixedVector<CellVisit, kAround> visits;
  const auto visit = [&](std::size_t i, float gap) {
    if (gap >= best.limit_sq_m2()) {
      return;
    }
    const std::uint32_t place = place_at(i);
    if (place != kNone) {
      visits.push_back({&cells_[place], gap});
    }
  };
  if (middle != kNone) {
    visits.push_back({&cells_[middle], 0.0F});
  }
  std::uint32_t seen = 1U << kMiddle;
  for (std::uint32_t bits = 1; bits < 8; ++bits) {
    std::int32_t number = kMiddle;
    float gap = 0.0F;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      if ((bits & (1U << axis)) != 0) {
        number += near[axis].number_step;
        gap += near[axis].gap_sq;
      }
    }
    seen |= 1U << number;
    visit(static_cast<std::size_t>(number), gap);
  }
  const std::span<const CellVisit> in_octant(visits.begin(), visits.size());
  search_(in_octant, 0, query_odom, best);
  if (best.limit_sq_m2() > least_far_sq) {
    for (std::size_t i = 0; i < kAround; ++i) {
      if ((seen & (1U << i)) == 0) {
        const Step& step = kSteps[i];
        visit(i, gap_sq[0][step.x + 1] + gap_sq[1][step.y + 1] + gap_sq[2][step.z + 1]);
      }
    }
    search_({visits.begin(), visits.size()}, in_octant.size(), query_odom, best);
  }

  Neighbours neighbours;
  neighbours.others_beyond_sq_m2 = best.limit_sq_m2();
  for (const std::uint64_t key : std::span(best.keys).first<Neighbours::kMax>()) {
    if (Nearest::distance_sq_m2(key) >= radius_sq) {
      break;
    }
    const std::uint32_t place = Nearest::place(key);
    neighbours.distance_sq_m2[neighbours.count] = Nearest::distance_sq_m2(key);
    neighbours.points_odom[neighbours.count] =
        visits[place / PointCell::kMaxPoints].cell->point(place % PointCell::kMaxPoints);
    ++neighbours.count;
  }
  return neighbours;
}

}  // namespace slamd::map
