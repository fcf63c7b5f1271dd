#include "core/occupancy/rolling_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace slamd::occupancy {

namespace {

/// A ray that passes a hit's place within this distance goes through what was hit. Units: cells, squared.
constexpr float kThrough2 = 0.5F * 0.5F;
/// In the last so many cells before its end a ray only grazes.
constexpr std::int32_t kEndSteps = 2;
constexpr float kPlaces = 32.0F;  // an axis, of a hit in its cell

std::int32_t blocks_for(double length_m, double cell_m) {
  return std::max(1, static_cast<std::int32_t>(std::lround(length_m / (kBlockSide * cell_m))));
}

/// Where in its cell a point lies. `local` and `cell` in cells.
std::uint16_t place_in(const Eigen::Vector3f& local, const Eigen::Vector3f& cell) {
  const Eigen::Array3i i = ((local - cell).array() * kPlaces).cast<int>().max(0).min(31);
  return static_cast<std::uint16_t>(i.x() | (i.y() << 5) | (i.z() << 10));
}

Eigen::Vector3f point_of(std::uint16_t place, const Eigen::Vector3f& cell) {
  return cell + (Eigen::Vector3f(static_cast<float>(place & 31), static_cast<float>((place >> 5) & 31), static_cast<float>(place >> 10)).array() + 0.5F)
                        .matrix() / kPlaces;
}

}  // namespace

Window window_about(const Eigen::Vector3d& p_odom, const GridConfig& config) {
  Window window;
  const std::int32_t side = blocks_for(config.box_m, config.cell_m);
  window.size = {side, side, blocks_for(config.height_m, config.cell_m)};
  const BlockIndex middle = cell_of(p_odom, config.cell_m).block();
  window.first = {middle.x - window.size[0] / 2, middle.y - window.size[1] / 2, middle.z - window.size[2] / 2};
  return window;
}

const std::size_t RollingGrid::kBlock_bytes = sizeof(Block) + sizeof(BlockStates) + sizeof(std::int32_t) + sizeof(std::uint64_t) + 3 * sizeof(std::uint32_t);

RollingGrid::RollingGrid(const GridConfig& config)
    : config_(config),
      states_(window_about(Eigen::Vector3d::Zero(), config), config.cell_m),
      changes_(states_.size()),
      submaps_(states_.size()),
      blocks_(states_.size()),
      ends_(config.max_points),
      touched_(states_.size()) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells_[axis] = kBlockSide * states_.window().size[axis];
    slots_[axis] = BoundedVector<std::uint32_t>(static_cast<std::size_t>(cells_[axis]));
    slots_[axis].resize(slots_[axis].capacity());
  }
  submaps_.resize(states_.size());
  restart(Eigen::Vector3d::Zero());
}

void RollingGrid::restart(const Eigen::Vector3d& p_odom) {
  states_.move_to(window_about(p_odom, config_).first, [](std::size_t, const BlockIndex&) {});
  states_.clear();
  digest_ = 0;
  blocks_.clear();
  blocks_.resize(blocks_.capacity());
  submap_ = -1;
  for (std::int32_t& submap : submaps_) {
    submap = submap_;
  }
  scan_ = 0;
  changes_.clear();
}

void RollingGrid::follow(const Eigen::Vector3d& p_odom) {
  const BlockIndex wanted = window_about(p_odom, config_).first;
  BlockIndex first = states_.window().first;
  const auto pull = [](std::int32_t& at, std::int32_t to) { at = std::abs(at - to) > 1 ? to : at; };
  pull(first.x, wanted.x);
  pull(first.y, wanted.y);
  pull(first.z, wanted.z);
  states_.move_to(first, [this](std::size_t slot, const BlockIndex& old) {
    digest_ -= states_.block(slot).digest(old);
    enter(static_cast<std::uint32_t>(slot));
  });
  // A cell's slot is the sum of what each of its coordinates gives.
  const BlockIndex corner = states_.window().block_at(0);  // has slot 0, and turns each axis
  const auto& size = states_.window().size;
  const std::array<std::int32_t, 3> turn{corner.x - first.x, corner.y - first.y, corner.z - first.z};
  const std::array<std::int32_t, 3> stride{1, size[0], size[0] * size[1]};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::int32_t i = 0; i < cells_[axis]; ++i) {
      const std::int32_t along = (i / kBlockSide - turn[axis] + size[axis]) % size[axis];
      slots_[axis][static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(stride[axis] * along);
    }
  }
}

void RollingGrid::enter(std::uint32_t slot) {
  blocks_[slot] = {};
  submaps_[slot] = submap_;
  changes_.touch(slot);
}

void RollingGrid::insert(const CarvingScan& scan) {
  follow(scan.T_odom_base.translation());
  ++scan_;
  touched_.clear();
  mark_hits(scan);
  const Eigen::Vector3f from = ((scan.origin_odom - first_corner()) / config_.cell_m).cast<float>();
  if (is_inside(from)) {
    for (const Eigen::Vector3f& end : ends_) {
      const bool ends_inside = is_inside(end);
      carve(from, ends_inside ? end : clipped(from, end), ends_inside);
    }
  }
  carve_body(scan.T_odom_base);
  for (const std::uint32_t slot : touched_) {
    apply(slot);
  }
  changes_.settle();
}

Eigen::Vector3d RollingGrid::first_corner() const {
  const BlockIndex& first = states_.window().first;
  return kBlockSide * config_.cell_m * Eigen::Vector3d(first.x, first.y, first.z);
}

bool RollingGrid::is_inside(const Eigen::Vector3f& local) const {
  return local.x() >= 0.0F && local.y() >= 0.0F && local.z() >= 0.0F && local.x() < static_cast<float>(cells_[0]) &&
         local.y() < static_cast<float>(cells_[1]) && local.z() < static_cast<float>(cells_[2]);
}

/// Returns where a ray from inside the window leaves it, a hair before.
Eigen::Vector3f RollingGrid::clipped(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const {
  const Eigen::Vector3f d = to - from;
  float share = 1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const float room = d[axis] > 0.0F ? static_cast<float>(cells_[static_cast<std::size_t>(axis)]) - from[axis] : -from[axis];
    share = d[axis] != 0.0F ? std::min(share, room / d[axis]) : share;
  }
  Eigen::Vector3f end = from + std::max(0.0F, share) * d;
  for (int axis = 0; axis < 3; ++axis) {
    const float last = static_cast<float>(cells_[static_cast<std::size_t>(axis)]);
    end[axis] = std::clamp(end[axis], 0.0F, std::nextafter(last, 0.0F));
  }
  return end;
}

RollingGrid::Block& RollingGrid::touch(std::uint32_t slot) {
  Block& block = blocks_[slot];
  if (block.scan != scan_) {
    block.scan = scan_;
    block.hits = block.misses = block.grazes = {};
    touched_.push_back(slot);
  }
  return block;
}

void RollingGrid::mark_hits(const CarvingScan& scan) {
  const Eigen::Matrix3d R = scan.T_odom_imu.rotation();
  const Eigen::Vector3d t = scan.T_odom_imu.translation() - first_corner();
  ends_.clear();
  for (const Eigen::Vector3f& p_imu : scan.points_imu) {
    const Eigen::Vector3f end = ((R * p_imu.cast<double>() + t) / config_.cell_m).cast<float>();
    if (!end.allFinite() || !ends_.try_push_back(end) || !is_inside(end)) {
      continue;
    }
    const Eigen::Vector3f corner = end.array().floor();
    const auto x = static_cast<std::int32_t>(corner.x());
    const auto y = static_cast<std::int32_t>(corner.y());
    const auto z = static_cast<std::int32_t>(corner.z());
    Block& block = touch(slots_[0][static_cast<std::size_t>(x)] + slots_[1][static_cast<std::size_t>(y)] + slots_[2][static_cast<std::size_t>(z)]);
    block.hits[static_cast<std::size_t>(z & 7)] |= std::uint64_t{1} << ((x & 7) + 8 * (y & 7));
    block.hit_place[static_cast<std::size_t>((x & 7) + 8 * (y & 7) + 64 * (z & 7))] = place_in(end, corner);
  }
}

void RollingGrid::carve(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool ends_inside) {
  const Eigen::Vector3f way = to - from;
  const float reach = way.cwiseAbs().maxCoeff();
  const Eigen::Vector3f step = way / std::max(reach, 1e-6F);  // one cell along the longest axis
  const Eigen::Vector3f direction = way.normalized();
  const auto steps = static_cast<std::int32_t>(reach);
  const std::int32_t last_through = ends_inside ? steps - kEndSteps : steps;
  std::uint32_t slot_at_hand = ~std::uint32_t{0};
  Block* block = nullptr;
  for (std::int32_t k = 0; k <= steps; ++k) {
    const auto at = [&](int axis) { return std::min(static_cast<std::int32_t>(from[axis] + static_cast<float>(k) * step[axis]), cells_[static_cast<std::size_t>(axis)] - 1); };
    const std::int32_t x = at(0);
    const std::int32_t y = at(1);
    const std::int32_t z = at(2);
    const std::uint32_t slot = slots_[0][static_cast<std::size_t>(x)] + slots_[1][static_cast<std::size_t>(y)] + slots_[2][static_cast<std::size_t>(z)];
    if (slot != slot_at_hand) {
      slot_at_hand = slot;
      block = &touch(slot);
    }
    const auto word = static_cast<std::size_t>(z & 7);
    const int place = (x & 7) + 8 * (y & 7);
    const std::uint64_t bit = std::uint64_t{1} << place;
    if ((block->solid[word] & bit) == 0) {
      block->misses[word] |= bit;
      continue;
    }
    const Eigen::Vector3f corner(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    const Eigen::Vector3f hit = point_of(block->hit_place[64 * word + static_cast<std::size_t>(place)], corner);
    const bool through = k <= last_through && (hit - from).cross(direction).squaredNorm() <= kThrough2;
    (through ? block->misses : block->grazes)[word] |= bit;
  }
}

void RollingGrid::carve_body(const geometry::Se3& T_odom_base) {
  const geometry::Se3 T_base_odom = T_odom_base.inverse();
  for (const BodyBox& box : config_.body) {
    // Of the cells about the box those whose middle lies in it.
    const Eigen::Vector3d min_base = Eigen::Vector3f::Map(box.min_m).cast<double>();
    const Eigen::Vector3d max_base = Eigen::Vector3f::Map(box.max_m).cast<double>();
    const Eigen::Vector3d middle_base = 0.5 * (min_base + max_base);
    const Eigen::Vector3d half = 0.5 * (max_base - min_base);
    const Eigen::Vector3d reach = T_odom_base.rotation().cwiseAbs() * half;
    const Eigen::Vector3d middle_odom = T_odom_base * middle_base;
    const CellIndex low = cell_of(middle_odom - reach, config_.cell_m);
    const CellIndex high = cell_of(middle_odom + reach, config_.cell_m);
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        for (std::int32_t x = low.x; x <= high.x; ++x) {
          const CellIndex cell{x, y, z};
          const Eigen::Vector3d p_base = T_base_odom * centre_of(cell, config_.cell_m);
          if (((p_base - middle_base).cwiseAbs().array() <= half.array()).all() && states_.window().contains(cell.block())) {
            Block& block = touch(static_cast<std::uint32_t>(states_.window().slot_of(cell.block())));
            const auto word = static_cast<std::size_t>(z & 7);
            const std::uint64_t bit = std::uint64_t{1} << (cell.place() & 63);
            block.hits[word] &= ~bit;
            block.misses[word] |= bit;
            block.evidence[static_cast<std::size_t>(cell.place())] = std::min(block.evidence[static_cast<std::size_t>(cell.place())], std::int8_t{0});
          }
        }
      }
    }
  }
}

void RollingGrid::apply(std::uint32_t slot) {
  const Evidence& evidence = config_.evidence;
  Block& block = blocks_[slot];
  BlockStates& states = states_.block(slot);
  const BlockStates before = states;
  for (std::size_t word = 0; word < kBlockSide; ++word) {
    const std::uint64_t hits = block.hits[word];
    const std::uint64_t misses = block.misses[word] & ~hits & ~block.settled[word];
    const std::uint64_t grazes = block.grazes[word] & ~hits & ~misses;
    for (std::uint64_t left = hits | misses | grazes; left != 0; left &= left - 1) {
      const int place_in_word = std::countr_zero(left);
      const std::uint64_t bit = left & (~left + 1);
      std::int8_t& value = block.evidence[64 * word + static_cast<std::size_t>(place_in_word)];
      const int change = (hits & bit) != 0 ? evidence.hit : (misses & bit) != 0 ? -evidence.miss : -evidence.graze;
      value = static_cast<std::int8_t>(std::clamp<int>(value + change, evidence.min, evidence.max));
      block.solid[word] = value > 0 ? block.solid[word] | bit : block.solid[word] & ~bit;
      block.settled[word] = value == evidence.min ? block.settled[word] | bit : block.settled[word] & ~bit;
      if (value >= evidence.occupied_at) {
        states.occupied[word] |= bit;
        states.free[word] &= ~bit;
      } else if (value <= evidence.free_at) {
        states.free[word] |= bit;
        states.occupied[word] &= ~bit;
      }
    }
  }
  if (states != before) {
    const BlockIndex index = states_.window().block_at(slot);
    digest_ += states.digest(index) - before.digest(index);
    submaps_[slot] = submap_;
    changes_.touch(slot);
  }
}

}  // namespace slamd::occupancy
