#include "core/scan/voxel_sampler.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/base/assert.hpp"

namespace slamd::scan {

namespace {

constexpr std::uint64_t kEmpty = std::numeric_limits<std::uint64_t>::max();  // a key has 63 bits

std::size_t slots_for(std::size_t points) { return std::bit_ceil(2 * points + 2); }

/// ⌊x⌋ without a call into libm, which this is without SSE 4.1.
std::int64_t floor_of(float x) {
  const auto whole = static_cast<std::int64_t>(x);
  return whole - (x < static_cast<float>(whole) ? 1 : 0);
}

std::uint64_t packed(const Eigen::Vector3f& p, float inverse_side) {
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = floor_of(p[axis] * inverse_side);
    key = (key << 21) | (static_cast<std::uint64_t>(cell) & kMask);
  }
  return key;
}

}  // namespace

VoxelSampler::VoxelSampler(std::size_t max_points) : slots_(slots_for(max_points)) {}

void VoxelSampler::reset(float side_m, std::size_t points) {
  SLAMD_ASSERT(slots_for(points) <= slots_.capacity());
  inverse_side_ = 1.0F / side_m;
  mask_ = slots_for(points) - 1;
  shift_ = 64 - std::bit_width(mask_);
  std::fill_n(slots_.data(), mask_ + 1, kEmpty);
}

bool VoxelSampler::admit(const Eigen::Vector3f& p) {
  const std::uint64_t key = packed(p, inverse_side_);
  // The product's upper bits depend on all of the key's.
  for (std::uint64_t i = (key * 0x9E3779B97F4A7C15ULL) >> shift_;; ++i) {
    std::uint64_t& slot = slots_.data()[i & mask_];
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
