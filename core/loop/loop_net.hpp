#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/loop/polar_image.hpp"

namespace slamd::loop {

/// What is kept of a place to find it again and to compare it with another: 15,872 bytes.
struct Descriptor {
  static constexpr std::size_t kLength = 128;
  static constexpr std::size_t kFeatures = 64;
  static constexpr std::size_t kColumns = 60;

  /// The same from every heading; of length 1. Places that are alike have a product near 1.
  std::array<float, kLength> global{};
  /// Features by azimuth, kFeatures rows of kColumns of 6° from x towards y in level; of length 1 altogether.
  std::array<float, kFeatures * kColumns> columns{};
};

/// Returns the product of two global descriptors, −1 to 1.
float similarity(const Descriptor& a, const Descriptor& b);

/// How two places compare.
struct Comparison {
  float overlap_logit = 0.0F;  // above 0: they are the same place, by the threshold that docs/loop-net.md states
  float yaw_rad = 0.0F;        // of b in a, −π to π: R_a_b = Rz(yaw_rad), p_a = R_a_b p_b + …, frames level
  float yaw_margin = 0.0F;     // by how much the best yaw's correlation exceeds the next best's, 30° and more away; 0 to 2
};

/// Loop-Net: a polar convolutional network with two heads for pairs, overlap and relative yaw. Plain C++; its weights are
/// linked in (core/loop/weights/loop_net.bin, made by tools/loopnet).
/// Source: backbone as in docs/loop-net.md; the heads' roles after [Liu22] and OverlapNet (Chen et al. 2020).
/// Real-time: memory in the constructor only; mapping thread only. 1 to 2 ms to describe, 0.03 ms to compare, one core.
class LoopNet {
 public:
  /// Takes the weights that are linked in.
  LoopNet();

  /// Takes weights as tools/loopnet/export.py writes them: 8 bytes of name, their number, floats, CRC-32, little-endian.
  /// Errors: std::invalid_argument where they are not Loop-Net's, or damaged.
  explicit LoopNet(std::span<const std::byte> weights);

  LoopNet(LoopNet&&) = default;
  LoopNet& operator=(LoopNet&&) = default;
  LoopNet(const LoopNet&) = delete;  // layers point into the weights
  LoopNet& operator=(const LoopNet&) = delete;

  /// Describes a place.
  void describe(const PolarImage& image, Descriptor& descriptor);

  /// Compares two places. Its yaw is heading(b) − heading(a), up to the network's error.
  Comparison compare(const Descriptor& a, const Descriptor& b);

 private:
  /// Rows of floats, each with room on both sides for what wraps around.
  struct Map {
    static constexpr std::size_t kBefore = 4;

    Map(std::size_t channel_count, std::size_t row_count, std::size_t column_count);

    float* row(std::size_t channel, std::size_t row) {
      return values.data() + (channel * rows + row) * stride + kBefore;
    }
    void wrap();

    std::size_t channels;
    std::size_t rows;
    std::size_t columns;
    std::size_t stride;
    std::vector<float> values;
  };

  struct Layer {
    const float* weights;  // taps × channels
    const float* bias;     // channels
  };

  void read(std::span<const float> floats);
  void fill_input(const PolarImage& image);
  void convolve_first();
  void convolve_second();
  void convolve(const Layer& layer, Map& in, Map& out, std::size_t ring_stride);
  void collapse_rings();
  void describe_columns(Descriptor& descriptor);
  void describe_globally(Descriptor& descriptor);
  void correlate(const Descriptor& a, const Descriptor& b);

  std::vector<float> floats_;
  Layer first_{};
  Layer second_{};
  Layer third_{};
  Layer fourth_{};
  Layer column_{};
  Layer context_{};
  Layer wide_{};
  Layer global_{};
  const float* sketch_ = nullptr;
  Layer hidden_{};
  Layer overlap_{};

  // scratch, sized once
  Map input_;
  Map even_;  // columns of the first layer's result
  Map odd_;
  Map second_map_;
  Map third_map_;
  Map fourth_map_;
  Map column_map_;
  Map wide_map_;
  std::vector<float> zeros_;
  std::vector<float> product_;
  std::vector<const float*> taps_;
  std::vector<float> twice_;         // columns of a, one turn behind the other
  std::vector<float> correlations_;  // by group of features
};

}  // namespace slamd::loop
