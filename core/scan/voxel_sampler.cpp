#include "core/scan/voxel_sampler.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/base/assert.hpp"

namespace slamd::scan {

using geometry::CellKey;

namespace {

constexpr CellKey kEmpty = std::numeric_limits<CellKey>::max();  // a key has 63 bits

std::size_t slots_for(std::size_t points) { return std::bit_ceil(2 * points + 2); }

}  // namespace

VoxelSampler::VoxelSampler(std::size_t max_points) : slots_(slots_for(max_points)) {}

void VoxelSampler::reset(float side_m, std::size_t points) {
  SLAMD_ASSERT(slots_for(points) <= slots_.capacity());
  inverse_side_ = 1.0F / side_m;
  mask_ = slots_for(points) - 1;
  home_ = geometry::CellHash(mask_ + 1);
  std::fill_n(slots_.data(), mask_ + 1, kEmpty);
}

bool VoxelSampler::admit(const Eigen::Vector3f& p) {
  const CellKey key = geometry::key_of(p, inverse_side_);
  for (std::size_t i = home_(key);; ++i) {
    CellKey& slot = slots_.data()[i & mask_];
    if (slot == kEmpty) {
      slot = key;
      return true;
    }
    if (slot == key) {
      return false;
    }
  }
}

}  // namespace slamd::scan
