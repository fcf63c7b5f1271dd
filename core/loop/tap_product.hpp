#pragma once

#include <cstddef>
#include <span>

namespace slamd::loop {

/// Columns that tap_product computes: a multiple of this many, so rows have room for as many.
inline constexpr std::size_t kTapColumns = 16;

/// Adds up weighted rows: out[c][n] = Σ_k weights[k][c] · taps[k][n]. All of Loop-Net's layers are this, a convolution with
/// the rows that its kernel meets as taps.
/// Shapes: taps[K] rows of at least `columns` floats, weights K × channels, out channels × out_stride. `channels` is a multiple
/// of 4 and `columns` one of kTapColumns.
/// The sums are taken in the order of k, without fused multiply-adds: the same bits on every machine.
/// Real-time: no allocation. AVX2 where there is, chosen at run time.
void tap_product(std::span<const float* const> taps,
                 const float* weights,
                 std::size_t channels,
                 std::size_t columns,
                 float* out,
                 std::size_t out_stride);

/// The same, written plainly: what tap_product is tested against.
void tap_product_plain(std::span<const float* const> taps,
                       const float* weights,
                       std::size_t channels,
                       std::size_t columns,
                       float* out,
                       std::size_t out_stride);

}  // namespace slamd::loop
