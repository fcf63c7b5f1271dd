#include "core/map/nearest.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace slamd::map {

namespace {

constexpr std::uint32_t kLanes = PointGroup::kSize;

#if defined(__x86_64__)
__attribute__((target("avx2,bmi"))) void search_cells_avx2(std::span<const CellVisit> visits,
                                                           std::size_t first,
                                                           const Eigen::Vector3f& query,
                                                           Nearest& best) {
  Nearest held = best;  // in registers
  const __m256 qx = _mm256_set1_ps(query.x());
  const __m256 qy = _mm256_set1_ps(query.y());
  const __m256 qz = _mm256_set1_ps(query.z());
  for (std::size_t v = first; v < visits.size(); ++v) {
    if (visits[v].gap_sq_m2 >= held.limit_sq_m2()) {
      continue;
    }
    const PointCell& cell = *visits[v].cell;
    const std::uint32_t groups = cell.groups_in_use();
    for (std::uint32_t g = 0; g < groups; ++g) {
      const PointGroup& group = cell.groups[g];
      const __m256 dx = _mm256_sub_ps(_mm256_load_ps(group.x_m), qx);
      const __m256 dy = _mm256_sub_ps(_mm256_load_ps(group.y_m), qy);
      const __m256 dz = _mm256_sub_ps(_mm256_load_ps(group.z_m), qz);
      const __m256 distance_sq =
          _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
      const __m256 nearer = _mm256_cmp_ps(distance_sq, _mm256_set1_ps(held.limit_sq_m2()), _CMP_LT_OQ);
      auto mask = static_cast<std::uint32_t>(_mm256_movemask_ps(nearer));
      if (mask == 0) {
        continue;
      }
      alignas(32) float lane[kLanes];
      _mm256_store_ps(lane, distance_sq);
      const std::uint32_t place = static_cast<std::uint32_t>(v) * PointCell::kMaxPoints + g * kLanes;
      for (; mask != 0; mask &= mask - 1) {
        const auto i = static_cast<std::uint32_t>(__builtin_ctz(mask));
        held.offer(Nearest::key_of(lane[i], place + i));
      }
    }
  }
  best = held;
}
#elif defined(__aarch64__)
float32x4_t distance_sq_of(const float* x_m, const float* y_m, const float* z_m, const Eigen::Vector3f& query) {
  const float32x4_t dx = vsubq_f32(vld1q_f32(x_m), vdupq_n_f32(query.x()));
  const float32x4_t dy = vsubq_f32(vld1q_f32(y_m), vdupq_n_f32(query.y()));
  const float32x4_t dz = vsubq_f32(vld1q_f32(z_m), vdupq_n_f32(query.z()));
  return vaddq_f32(vaddq_f32(vmulq_f32(dx, dx), vmulq_f32(dy, dy)), vmulq_f32(dz, dz));
}

void search_cells_neon(std::span<const CellVisit> visits,
                       std::size_t first,
                       const Eigen::Vector3f& query,
                       Nearest& best) {
  for (std::size_t v = first; v < visits.size(); ++v) {
    if (visits[v].gap_sq_m2 >= best.limit_sq_m2()) {
      continue;
    }
    const PointCell& cell = *visits[v].cell;
    const std::uint32_t groups = cell.groups_in_use();
    for (std::uint32_t g = 0; g < groups; ++g) {
      const PointGroup& group = cell.groups[g];
      const float32x4_t low = distance_sq_of(group.x_m, group.y_m, group.z_m, query);
      const float32x4_t high = distance_sq_of(group.x_m + 4, group.y_m + 4, group.z_m + 4, query);
      const float limit_sq = best.limit_sq_m2();
      if (vminvq_f32(vminq_f32(low, high)) >= limit_sq) {
        continue;
      }
      float lane[kLanes];
      vst1q_f32(lane, low);
      vst1q_f32(lane + 4, high);
      const std::uint32_t place = static_cast<std::uint32_t>(v) * PointCell::kMaxPoints + g * kLanes;
      for (std::uint32_t i = 0; i < kLanes; ++i) {
        if (lane[i] < limit_sq) {
          best.offer(Nearest::key_of(lane[i], place + i));
        }
      }
    }
  }
}
#endif

}  // namespace

void search_cells_scalar(std::span<const CellVisit> visits,
                         std::size_t first,
                         const Eigen::Vector3f& query,
                         Nearest& best) {
  for (std::size_t v = first; v < visits.size(); ++v) {
    if (visits[v].gap_sq_m2 >= best.limit_sq_m2()) {
      continue;
    }
    const PointCell& cell = *visits[v].cell;
    for (std::uint32_t i = 0; i < cell.count; ++i) {
      const Eigen::Vector3f p = cell.point(i);
      const float dx = p.x() - query.x();
      const float dy = p.y() - query.y();
      const float dz = p.z() - query.z();
      const float distance_sq = (dx * dx + dy * dy) + dz * dz;
      if (distance_sq < best.limit_sq_m2()) {
        best.offer(Nearest::key_of(distance_sq, static_cast<std::uint32_t>(v) * PointCell::kMaxPoints + i));
      }
    }
  }
}

CellSearch fastest_cell_search() {
#if defined(__x86_64__)
  const bool able = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0;
  return able ? search_cells_avx2 : search_cells_scalar;
#elif defined(__aarch64__)
  return search_cells_neon;
#else
  return search_cells_scalar;
#endif
}

}  // namespace slamd::map
