#include "core/loop/tap_product.hpp"

#include <cstring>

namespace slamd::loop {

namespace {

using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));

/// A block of 4 channels by two vectors of columns stays in registers while all taps go by.
template <typename Vector>
__attribute__((always_inline)) inline void multiply(std::span<const float* const> taps, const float* weights,
                                                    std::size_t channels, std::size_t columns, float* out,
                                                    std::size_t out_stride) {
  constexpr std::size_t kLanes = sizeof(Vector) / sizeof(float);
  for (std::size_t n = 0; n < columns; n += 2 * kLanes) {
    for (std::size_t c = 0; c < channels; c += 4) {
      Vector sums[4][2] = {};
      const float* w = weights + c;
      for (std::size_t k = 0; k < taps.size(); ++k, w += channels) {
        Vector low;
        Vector high;
        std::memcpy(&low, taps[k] + n, sizeof(low));
        std::memcpy(&high, taps[k] + n + kLanes, sizeof(high));
        for (std::size_t i = 0; i < 4; ++i) {
          sums[i][0] += w[i] * low;
          sums[i][1] += w[i] * high;
        }
      }
      for (std::size_t i = 0; i < 4; ++i) {
        std::memcpy(out + (c + i) * out_stride + n, &sums[i][0], sizeof(Vector));
        std::memcpy(out + (c + i) * out_stride + n + kLanes, &sums[i][1], sizeof(Vector));
      }
    }
  }
}

using Multiply = void (*)(std::span<const float* const>, const float*, std::size_t, std::size_t, float*, std::size_t);

void multiply_by_4(std::span<const float* const> taps, const float* weights, std::size_t channels, std::size_t columns,
                   float* out, std::size_t out_stride) {
  multiply<Float4>(taps, weights, channels, columns, out, out_stride);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void multiply_by_8(std::span<const float* const> taps, const float* weights,
                                                   std::size_t channels, std::size_t columns, float* out,
                                                   std::size_t out_stride) {
  multiply<Float8>(taps, weights, channels, columns, out, out_stride);
}
#endif

Multiply fastest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") != 0) {
    return multiply_by_8;
  }
#endif
  return multiply_by_4;
}

}  // namespace

void tap_product(std::span<const float* const> taps, const float* weights, std::size_t channels, std::size_t columns,
                 float* out, std::size_t out_stride) {
  static const Multiply chosen = fastest();
  chosen(taps, weights, channels, columns, out, out_stride);
}

void tap_product_plain(std::span<const float* const> taps, const float* weights, std::size_t channels,
                       std::size_t columns, float* out, std::size_t out_stride) {
  for (std::size_t c = 0; c < channels; ++c) {
    for (std::size_t n = 0; n < columns; ++n) {
      float sum = 0.0F;
      for (std::size_t k = 0; k < taps.size(); ++k) {
        sum += weights[k * channels + c] * taps[k][n];
      }
      out[c * out_stride + n] = sum;
    }
  }
}

}  // namespace slamd::loop
