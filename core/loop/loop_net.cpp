#include "core/loop/loop_net.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <stdexcept>

#include "core/base/bytes.hpp"
#include "core/base/crc32.hpp"
#include "core/loop/loop_net_weights.hpp"
#include "core/loop/tap_product.hpp"

namespace slamd::loop {

namespace {

// The network's shape, as tools/loopnet/model.py has it.
constexpr std::size_t kInput = PolarImage::kSlices;
constexpr std::size_t kFirst = 16;
constexpr std::size_t kSecond = 32;
constexpr std::size_t kThird = 40;
constexpr std::size_t kFourth = 48;
constexpr std::size_t kFeatures = Descriptor::kFeatures;
constexpr std::size_t kColumns = Descriptor::kColumns;
constexpr std::size_t kLength = Descriptor::kLength;
constexpr std::size_t kRings = 5;       // that are left after the fourth layer
constexpr std::size_t kKernel = 3;      // rings and azimuths
constexpr std::size_t kContext = 5;     // columns
constexpr std::size_t kGroups = 8;      // of features, correlated each on its own
constexpr std::size_t kSketch = 8;
constexpr std::size_t kStatistics = 6;
constexpr std::size_t kClues = kStatistics + kGroups + kSketch;
constexpr std::size_t kHidden = 32;
constexpr std::size_t kPeakBins = 5;    // around the best yaw that no second one is looked for
constexpr float kBin_rad = 2.0F * std::numbers::pi_v<float> / static_cast<float>(kColumns);

constexpr std::size_t kFloats =
    kInput * 9 * kFirst + kFirst + kFirst * 9 * kSecond + kSecond + kSecond * 9 * kThird + kThird + kThird * 9 * kFourth +
    kFourth + kFourth * kRings * kFeatures + kFeatures + kFeatures * kContext * kFeatures + kFeatures +
    kFeatures * kKernel * kLength + kLength + 2 * kLength * kLength + kLength + kLength * kSketch + kClues * kHidden +
    kHidden + kHidden + 1;
constexpr char kName[] = "slamdLN1";
constexpr std::size_t kHeaderBytes = 12;

std::size_t padded(std::size_t columns) { return (columns + kTapColumns - 1) / kTapColumns * kTapColumns; }

std::vector<float> floats_of(std::span<const std::byte> weights) {
  if (weights.size() != kHeaderBytes + 4 * kFloats + 4 || std::memcmp(weights.data(), kName, 8) != 0 ||
      load_le<std::uint32_t>(weights, 8) != kFloats) {
    throw std::invalid_argument("these are not Loop-Net's weights");
  }
  if (load_le<std::uint32_t>(weights, weights.size() - 4) != crc32(weights.first(weights.size() - 4))) {
    throw std::invalid_argument("Loop-Net's weights are damaged");
  }
  std::vector<float> floats(kFloats);
  for (std::size_t i = 0; i < kFloats; ++i) {
    floats[i] = load_le<float>(weights, kHeaderBytes + 4 * i);
  }
  return floats;
}

float rectified(float value) { return std::max(value, 0.0F); }

/// Eight sums side by side: quick, and the same on every machine.
float dot(const float* a, const float* b, std::size_t count) {
  std::array<float, 8> sums{};
  for (std::size_t i = 0; i < count; i += sums.size()) {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      sums[k] += a[i + k] * b[i + k];
    }
  }
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

void divide_by_length(std::span<float> values) {
  const float length = std::sqrt(dot(values.data(), values.data(), values.size()));
  for (float& value : values) {
    value /= std::max(length, 1e-6F);
  }
}

/// The peak of a circular correlation.
struct Peak {
  std::size_t best = 0;
  float vertex_bins = 0.0F;  // of the parabola through it and its neighbours
  float height = 0.0F;
  float second = 0.0F;  // the greatest farther than kPeakBins away
};

Peak peak_of(std::span<const float, kColumns> correlation) {
  Peak peak;
  peak.best = static_cast<std::size_t>(std::max_element(correlation.begin(), correlation.end()) - correlation.begin());
  peak.height = correlation[peak.best];
  const float before = correlation[(peak.best + kColumns - 1) % kColumns];
  const float after = correlation[(peak.best + 1) % kColumns];
  const float curve = std::min(before - 2.0F * peak.height + after, -1e-9F);
  peak.vertex_bins = static_cast<float>(peak.best) + std::clamp(0.5F * (before - after) / curve, -0.5F, 0.5F);
  peak.second = -2.0F;
  for (std::size_t apart = kPeakBins + 1; apart < kColumns - kPeakBins; ++apart) {
    peak.second = std::max(peak.second, correlation[(peak.best + apart) % kColumns]);
  }
  return peak;
}

}  // namespace

float similarity(const Descriptor& a, const Descriptor& b) {
  return dot(a.global.data(), b.global.data(), kLength);
}

LoopNet::Map::Map(std::size_t channel_count, std::size_t row_count, std::size_t column_count)
    : channels(channel_count),
      rows(row_count),
      columns(column_count),
      stride(kBefore + padded(column_count) + kBefore),
      values(channel_count * row_count * stride + kTapColumns) {}

/// Copies the last columns before the first ones, and the first ones behind the last.
void LoopNet::Map::wrap() {
  constexpr std::size_t kWrapped = 2;
  for (std::size_t i = 0; i < channels * rows; ++i) {
    float* first = values.data() + i * stride + kBefore;
    for (std::size_t k = 0; k < kWrapped; ++k) {
      *(first - 1 - k) = first[columns - 1 - k];
      first[columns + k] = first[k];
    }
  }
}

LoopNet::LoopNet() : LoopNet(linked_weights()) {}

LoopNet::LoopNet(std::span<const std::byte> weights)
    : floats_(floats_of(weights)),
      input_(kInput, PolarImage::kRings, PolarImage::kAzimuths),
      even_(kFirst, 20, kColumns),
      odd_(kFirst, 20, kColumns),
      second_map_(kSecond, 10, kColumns),
      third_map_(kThird, 10, kColumns),
      fourth_map_(kFourth, kRings, kColumns),
      column_map_(kFeatures, 1, kColumns),
      wide_map_(kLength, 1, kColumns),
      zeros_(256),
      product_(kLength * padded(PolarImage::kAzimuths)),
      taps_(kThird * kKernel * kKernel),
      twice_(kFeatures * (2 * kColumns + kTapColumns)),
      correlations_(kGroups * padded(kColumns)) {
  read(floats_);
}

/// Finds each layer's weights; the order is that of tools/loopnet/export.py.
void LoopNet::read(std::span<const float> floats) {
  std::size_t at = 0;
  const auto take = [&](std::size_t count) {
    const float* part = floats.data() + at;
    at += count;
    return part;
  };
  const auto layer = [&](std::size_t taps, std::size_t channels) {
    const float* weights = take(taps * channels);
    return Layer{weights, take(channels)};
  };
  first_ = layer(kInput * 9, kFirst);
  second_ = layer(kFirst * 9, kSecond);
  third_ = layer(kSecond * 9, kThird);
  fourth_ = layer(kThird * 9, kFourth);
  column_ = layer(kFourth * kRings, kFeatures);
  context_ = layer(kFeatures * kContext, kFeatures);
  wide_ = layer(kFeatures * kKernel, kLength);
  global_ = layer(2 * kLength, kLength);
  sketch_ = take(kLength * kSketch);
  hidden_ = layer(kClues, kHidden);
  overlap_ = layer(kHidden, 1);
}

/// log2(1 + n), divided by its mean over the cells that are not empty: more beams or thinned points change little.
void LoopNet::fill_input(const PolarImage& image) {
  std::uint32_t sum = 0;
  std::uint32_t occupied = 0;
  for (const std::uint8_t cell : image.cells) {
    sum += cell;
    occupied += cell > 0 ? 1U : 0U;
  }
  const float mean = static_cast<float>(sum) / 32.0F / static_cast<float>(std::max(occupied, 1U));
  const float scale = 1.0F / std::max(mean, 1.0F / 32.0F) / 32.0F;
  for (std::size_t slice = 0; slice < kInput; ++slice) {
    for (std::size_t ring = 0; ring < PolarImage::kRings; ++ring) {
      const std::uint8_t* cells = &image.cells[PolarImage::index(slice, ring, 0)];
      float* row = input_.row(slice, ring);
      for (std::size_t azimuth = 0; azimuth < PolarImage::kAzimuths; ++azimuth) {
        row[azimuth] = scale * static_cast<float>(cells[azimuth]);
      }
    }
  }
  input_.wrap();
}

/// Every second ring, every azimuth; even and odd azimuths are laid apart for the layer that follows.
void LoopNet::convolve_first() {
  const std::size_t stride = padded(PolarImage::kAzimuths);
  for (std::size_t r = 0; r < even_.rows; ++r) {
    std::size_t tap = 0;
    for (std::size_t channel = 0; channel < kInput; ++channel) {
      for (std::size_t k = 0; k < kKernel; ++k) {
        const std::size_t ring = 2 * r + k;  // one more than the ring's number
        const float* row = ring == 0 ? zeros_.data() + Map::kBefore : input_.row(channel, ring - 1);
        for (std::size_t i = 0; i < kKernel; ++i) {
          taps_[tap++] = row + i - 1;
        }
      }
    }
    tap_product({taps_.data(), tap}, first_.weights, kFirst, stride, product_.data(), stride);
    for (std::size_t channel = 0; channel < kFirst; ++channel) {
      const float* sums = product_.data() + channel * stride;
      float* even = even_.row(channel, r);
      float* odd = odd_.row(channel, r);
      for (std::size_t column = 0; column < kColumns; ++column) {
        even[column] = rectified(sums[2 * column] + first_.bias[channel]);
        odd[column] = rectified(sums[2 * column + 1] + first_.bias[channel]);
      }
    }
  }
  even_.wrap();
  odd_.wrap();
}

/// Every second ring, every second azimuth.
void LoopNet::convolve_second() {
  const std::size_t stride = padded(kColumns);
  for (std::size_t r = 0; r < second_map_.rows; ++r) {
    std::size_t tap = 0;
    for (std::size_t channel = 0; channel < kFirst; ++channel) {
      for (std::size_t k = 0; k < kKernel; ++k) {
        const std::size_t ring = 2 * r + k;
        const float* zero = zeros_.data() + Map::kBefore;
        const float* even = ring == 0 ? zero : even_.row(channel, ring - 1);
        const float* odd = ring == 0 ? zero : odd_.row(channel, ring - 1);
        taps_[tap++] = odd - 1;
        taps_[tap++] = even;
        taps_[tap++] = odd;
      }
    }
    tap_product({taps_.data(), tap}, second_.weights, kSecond, stride, product_.data(), stride);
    for (std::size_t channel = 0; channel < kSecond; ++channel) {
      const float* sums = product_.data() + channel * stride;
      float* out = second_map_.row(channel, r);
      for (std::size_t column = 0; column < kColumns; ++column) {
        out[column] = rectified(sums[column] + second_.bias[channel]);
      }
    }
  }
  second_map_.wrap();
}

/// Every ring or every second one, every azimuth.
void LoopNet::convolve(const Layer& layer, Map& in, Map& out, std::size_t ring_stride) {
  const std::size_t stride = padded(kColumns);
  for (std::size_t r = 0; r < out.rows; ++r) {
    std::size_t tap = 0;
    for (std::size_t channel = 0; channel < in.channels; ++channel) {
      for (std::size_t k = 0; k < kKernel; ++k) {
        const std::size_t ring = ring_stride * r + k;
        const float* row =
            ring == 0 || ring > in.rows ? zeros_.data() + Map::kBefore : in.row(channel, ring - 1);
        for (std::size_t i = 0; i < kKernel; ++i) {
          taps_[tap++] = row + i - 1;
        }
      }
    }
    tap_product({taps_.data(), tap}, layer.weights, out.channels, stride, product_.data(), stride);
    for (std::size_t channel = 0; channel < out.channels; ++channel) {
      const float* sums = product_.data() + channel * stride;
      float* row = out.row(channel, r);
      for (std::size_t column = 0; column < kColumns; ++column) {
        row[column] = rectified(sums[column] + layer.bias[channel]);
      }
    }
  }
  out.wrap();
}

/// What is left of the rings becomes features of each column.
void LoopNet::collapse_rings() {
  std::size_t tap = 0;
  for (std::size_t channel = 0; channel < kFourth; ++channel) {
    for (std::size_t ring = 0; ring < kRings; ++ring) {
      taps_[tap++] = fourth_map_.row(channel, ring);
    }
  }
  const std::size_t stride = padded(kColumns);
  tap_product({taps_.data(), tap}, column_.weights, kFeatures, stride, product_.data(), stride);
  for (std::size_t feature = 0; feature < kFeatures; ++feature) {
    float* row = column_map_.row(feature, 0);
    for (std::size_t column = 0; column < kColumns; ++column) {
      row[column] = rectified(product_[feature * stride + column] + column_.bias[feature]);
    }
  }
  column_map_.wrap();
}

void LoopNet::describe_columns(Descriptor& descriptor) {
  std::size_t tap = 0;
  for (std::size_t feature = 0; feature < kFeatures; ++feature) {
    for (std::size_t k = 0; k < kContext; ++k) {
      taps_[tap++] = column_map_.row(feature, 0) + k - 2;
    }
  }
  const std::size_t stride = padded(kColumns);
  tap_product({taps_.data(), tap}, context_.weights, kFeatures, stride, product_.data(), stride);
  for (std::size_t feature = 0; feature < kFeatures; ++feature) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      descriptor.columns[feature * kColumns + column] = product_[feature * stride + column] + context_.bias[feature];
    }
  }
  divide_by_length(descriptor.columns);
}

void LoopNet::describe_globally(Descriptor& descriptor) {
  std::size_t tap = 0;
  for (std::size_t feature = 0; feature < kFeatures; ++feature) {
    for (std::size_t k = 0; k < kKernel; ++k) {
      taps_[tap++] = column_map_.row(feature, 0) + k - 1;
    }
  }
  const std::size_t stride = padded(kColumns);
  tap_product({taps_.data(), tap}, wide_.weights, kLength, stride, product_.data(), stride);
  std::array<float, 2 * kLength> pooled{};
  for (std::size_t channel = 0; channel < kLength; ++channel) {
    float sum = 0.0F;
    float most = 0.0F;
    for (std::size_t column = 0; column < kColumns; ++column) {
      const float value = rectified(product_[channel * stride + column] + wide_.bias[channel]);
      sum += value;
      most = std::max(most, value);
    }
    pooled[channel] = sum / static_cast<float>(kColumns);
    pooled[kLength + channel] = most;
  }
  for (std::size_t i = 0; i < kLength; ++i) {
    descriptor.global[i] = global_.bias[i] + dot(global_.weights + i * pooled.size(), pooled.data(), pooled.size());
  }
  divide_by_length(descriptor.global);
}

void LoopNet::describe(const PolarImage& image, Descriptor& descriptor) {
  fill_input(image);
  convolve_first();
  convolve_second();
  convolve(third_, second_map_, third_map_, 1);
  convolve(fourth_, third_map_, fourth_map_, 2);
  collapse_rings();
  describe_columns(descriptor);
  describe_globally(descriptor);
}

/// Correlates the columns for all shifts, group by group: Σ over columns j of a[j + shift] b[j].
void LoopNet::correlate(const Descriptor& a, const Descriptor& b) {
  constexpr std::size_t kLong = 2 * kColumns + kTapColumns;
  constexpr std::size_t kSize = kFeatures / kGroups;
  constexpr std::size_t kShifts = 64;
  for (std::size_t feature = 0; feature < kFeatures; ++feature) {
    const float* row = &a.columns[feature * kColumns];
    std::copy_n(row, kColumns, twice_.data() + feature * kLong);
    std::copy_n(row, kColumns, twice_.data() + feature * kLong + kColumns);
  }
  for (std::size_t group = 0; group < kGroups; ++group) {
    float* sums = correlations_.data() + group * kShifts;
    for (std::size_t half = 0; half < kShifts; half += kShifts / 2) {
      std::array<float, kShifts / 2> part{};
      for (std::size_t feature = group * kSize; feature < (group + 1) * kSize; ++feature) {
        const float* from = twice_.data() + feature * kLong + half;
        const float* weights = &b.columns[feature * kColumns];
        for (std::size_t column = 0; column < kColumns; ++column) {
          for (std::size_t shift = 0; shift < part.size(); ++shift) {
            part[shift] += weights[column] * from[column + shift];
          }
        }
      }
      std::copy(part.begin(), part.end(), sums + half);
    }
  }
}

Comparison LoopNet::compare(const Descriptor& a, const Descriptor& b) {
  constexpr std::size_t kShifts = 64;
  correlate(a, b);
  std::array<float, kColumns> correlation{};
  for (std::size_t group = 0; group < kGroups; ++group) {
    for (std::size_t shift = 0; shift < kColumns; ++shift) {
      correlation[shift] += correlations_[group * kShifts + shift];
    }
  }
  const Peak peak = peak_of(correlation);
  float mean = 0.0F;
  for (const float value : correlation) {
    mean += value / static_cast<float>(kColumns);
  }
  float variance = 0.0F;
  for (const float value : correlation) {
    variance += (value - mean) * (value - mean) / static_cast<float>(kColumns);
  }
  std::array<float, kClues> clues{peak.height, mean,  std::sqrt(std::max(variance, 1e-12F)),
                                  peak.second, peak.height - peak.second, similarity(a, b)};
  for (std::size_t group = 0; group < kGroups; ++group) {
    clues[kStatistics + group] = static_cast<float>(kGroups) * correlations_[group * kShifts + peak.best];
  }
  for (std::size_t i = 0; i < kSketch; ++i) {
    clues[kStatistics + kGroups + i] = static_cast<float>(kSketch) * dot(sketch_ + i * kLength, a.global.data(), kLength) *
                                       dot(sketch_ + i * kLength, b.global.data(), kLength);
  }
  float logit = overlap_.bias[0];
  for (std::size_t i = 0; i < kHidden; ++i) {
    float sum = hidden_.bias[i];
    for (std::size_t k = 0; k < kClues; ++k) {
      sum += hidden_.weights[i * kClues + k] * clues[k];
    }
    logit += overlap_.weights[i] * rectified(sum);
  }
  return {logit, std::remainder(peak.vertex_bins * kBin_rad, 2.0F * std::numbers::pi_v<float>), peak.height - peak.second};
}

}  // namespace slamd::loop
