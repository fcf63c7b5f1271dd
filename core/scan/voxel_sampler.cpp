#include "core/scan/voxel_sampler.hpp"

#include <bit>
#include <cmath>

namespace slamd::scan {

namespace {

std::uint64_t packed(const Eigen::Vector3f& p, float inverse_side) {
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::int64_t>(std::floor(p[axis] * inverse_side));
    key = (key << 21) | (static_cast<std::uint64_t>(cell) & kMask);
  }
  return key;
}

}  // namespace

VoxelSampler::VoxelSampler(std::size_t max_points) : slots_(std::bit_ceil(2 * max_points + 2)) {
  slots_.resize(slots_.capacity());
  mask_ = slots_.capacity() - 1;
}

void VoxelSampler::reset(float side_m) {
  inverse_side_ = 1.0F / side_m;
  ++generation_;
}

bool VoxelSampler::admit(const Eigen::Vector3f& p) {
  const std::uint64_t key = packed(p, inverse_side_);
  for (std::uint64_t i = (key * 0x9E3779B97F4A7C15ULL) >> 20;; ++i) {
    Slot& slot = slots_[i & mask_];
    if (slot.generation != generation_) {
      slot = {key, generation_};
      return true;
    }
    if (slot.key == key) {
      return false;
    }
  }
}

}  // namespace slamd::scan
