#pragma once

#include <functional>
#include <vector>

#include "tools/simulate/surfaces.hpp"

namespace slamd::simulate {

/// Ground as a height over the plan: bilinear patches between lines of x and lines of y, which need not be evenly
/// spaced, so that a kerb is a patch of a centimetre's width.
/// Frames: world, z up.  Units: m.
class HeightField {
 public:
  /// Lines at which the ground has a step, beside the even ones.
  struct Breaks {
    std::vector<double> x;
    std::vector<double> y;
  };

  /// Samples `height` over [0, extent] at lines `spacing_m` apart, and on both sides of each break.
  HeightField(const std::function<double(double, double)>& height, const Eigen::Vector2d& extent_m, double spacing_m,
              const Breaks& breaks);

  double height(double x, double y) const;
  double highest() const { return highest_; }

  /// Shortens `best` to where the ray first goes below the ground.
  void cast(const Ray& ray, Hit& best) const;

  /// The same without leaving anything out: what cast is tested against.
  void cast_brute_force(const Ray& ray, Hit& best) const;

 private:
  static constexpr int kBlock = 8;  // patches that are passed over together, in each direction

  /// The lines of one direction.
  struct Lines {
    std::vector<double> at;
    std::vector<int> first;  // of each bin
    double extent = 0.0;

    Lines(double extent_m, double spacing_m, const std::vector<double>& breaks);
    int patch(double v) const;
    int patches() const { return static_cast<int>(at.size()) - 1; }
  };

  float node(int column, int row) const {
    return heights_[static_cast<std::size_t>(row * (columns_.patches() + 1) + column)];
  }
  bool cast_patch(int column, int row, const Ray& ray, double from, double to, Hit& best) const;
  bool cast_patches(const Ray& ray, double from, double to, Hit& best) const;

  Lines columns_;
  Lines rows_;
  std::vector<float> heights_;    // of the nodes, row by row
  std::vector<float> block_top_;  // of blocks of patches
  int blocks_across_ = 0;
  double highest_ = 0.0;
};

}  // namespace slamd::simulate
