#include "core/map/nearest.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace slamd::map {

namespace {

void offer(const PointCell& cell, std::uint32_t i, float distance_sq, float radius_sq, Neighbours& best) {
  if (distance_sq < best.limit_sq(radius_sq)) {
    best.insert(distance_sq, {cell.x_m[i], cell.y_m[i], cell.z_m[i]});
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void search_cell_avx2(const PointCell& cell,
                                                      const Eigen::Vector3f& query,
                                                      float radius_sq,
                                                      Neighbours& best) {
  const __m256 qx = _mm256_set1_ps(query.x());
  const __m256 qy = _mm256_set1_ps(query.y());
  const __m256 qz = _mm256_set1_ps(query.z());
  for (std::uint32_t begin = 0; begin < cell.count; begin += 8) {
    const __m256 dx = _mm256_sub_ps(_mm256_load_ps(cell.x_m + begin), qx);
    const __m256 dy = _mm256_sub_ps(_mm256_load_ps(cell.y_m + begin), qy);
    const __m256 dz = _mm256_sub_ps(_mm256_load_ps(cell.z_m + begin), qz);
    const __m256 distance_sq =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
    const __m256 nearer =
        _mm256_cmp_ps(distance_sq, _mm256_set1_ps(best.limit_sq(radius_sq)), _CMP_LT_OQ);
    auto mask = static_cast<std::uint32_t>(_mm256_movemask_ps(nearer));
    if (cell.count - begin < 8) {
      mask &= (1U << (cell.count - begin)) - 1;
    }
    alignas(32) float lane[8];
    if (mask != 0) {
      _mm256_store_ps(lane, distance_sq);
    }
    for (; mask != 0; mask &= mask - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(mask));
      offer(cell, begin + i, lane[i], radius_sq, best);
    }
  }
}
#elif defined(__aarch64__)
void search_cell_neon(const PointCell& cell, const Eigen::Vector3f& query, float radius_sq, Neighbours& best) {
  const float32x4_t qx = vdupq_n_f32(query.x());
  const float32x4_t qy = vdupq_n_f32(query.y());
  const float32x4_t qz = vdupq_n_f32(query.z());
  for (std::uint32_t begin = 0; begin < cell.count; begin += 4) {
    const float32x4_t dx = vsubq_f32(vld1q_f32(cell.x_m + begin), qx);
    const float32x4_t dy = vsubq_f32(vld1q_f32(cell.y_m + begin), qy);
    const float32x4_t dz = vsubq_f32(vld1q_f32(cell.z_m + begin), qz);
    const float32x4_t distance_sq =
        vaddq_f32(vaddq_f32(vmulq_f32(dx, dx), vmulq_f32(dy, dy)), vmulq_f32(dz, dz));
    float lane[4];
    vst1q_f32(lane, distance_sq);
    for (std::uint32_t i = 0; i < 4 && begin + i < cell.count; ++i) {
      offer(cell, begin + i, lane[i], radius_sq, best);
    }
  }
}
#endif

}  // namespace

void search_cell_scalar(const PointCell& cell, const Eigen::Vector3f& query, float radius_sq, Neighbours& best) {
  for (std::uint32_t i = 0; i < cell.count; ++i) {
    const float dx = cell.x_m[i] - query.x();
    const float dy = cell.y_m[i] - query.y();
    const float dz = cell.z_m[i] - query.z();
    offer(cell, i, (dx * dx + dy * dy) + dz * dz, radius_sq, best);
  }
}

CellSearch fastest_cell_search() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0 ? search_cell_avx2 : search_cell_scalar;
#elif defined(__aarch64__)
  return search_cell_neon;
#else
  return search_cell_scalar;
#endif
}

}  // namespace slamd::map
