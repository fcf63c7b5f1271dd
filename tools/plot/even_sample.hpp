#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace slamd::plot {

/// Keeps at most `capacity` points, evenly spread over all that were offered: whenever it is full, every other one goes
/// and from then on half as many are taken. The same points give the same sample.
class EvenSample {
 public:
  /// `capacity` is at least 2.
  explicit EvenSample(std::size_t capacity) : capacity_(capacity) {}

  void offer(const Eigen::Vector3f& point) {
    if (offered_++ % stride_ != 0) {
      return;
    }
    if (points_.size() == capacity_) {
      halve();
      if ((offered_ - 1) % stride_ != 0) {
        return;
      }
    }
    points_.push_back(point);
  }

  const std::vector<Eigen::Vector3f>& points() const { return points_; }

 private:
  void halve() {
    const std::size_t kept = (points_.size() + 1) / 2;
    for (std::size_t i = 1; i < kept; ++i) {
      points_[i] = points_[2 * i];
    }
    points_.resize(kept);
    stride_ *= 2;
  }

  std::size_t capacity_;
  std::uint64_t stride_ = 1;
  std::uint64_t offered_ = 0;
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace slamd::plot
