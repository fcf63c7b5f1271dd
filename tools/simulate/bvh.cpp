#include "tools/simulate/bvh.hpp"

#include <array>
#include <numeric>

namespace slamd::simulate {

namespace {

constexpr std::uint32_t kLeaf = 2;
constexpr int kBins = 16;
constexpr int kMaxDepth = 60;  // less than the stack of visit
constexpr float kPad_m = 2e-4F;  // more than single precision loses

float area(const Bounds& bounds) {
  const Eigen::Vector3f size = (bounds.high - bounds.low).cwiseMax(0.0F);
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

struct Bin {
  Bounds bounds;
  std::uint32_t count = 0;
};

/// The cheapest place to cut: before bin `bin` along `axis`.
struct Cut {
  int axis = -1;
  int bin = 0;
  float cost = 1e30F;
};

}  // namespace

void Bvh::build(std::span<const Bounds> bounds) {
  nodes_.clear();
  order_.resize(bounds.size());
  std::iota(order_.begin(), order_.end(), 0U);
  if (bounds.empty()) {
    return;
  }
  nodes_.reserve(2 * bounds.size());
  nodes_.emplace_back();
  split(0, bounds, 0, static_cast<std::uint32_t>(bounds.size()), 0);
}

void Bvh::split(std::uint32_t node, std::span<const Bounds> bounds, std::uint32_t first, std::uint32_t count,
                int depth) {
  Bounds all;
  Bounds centres;
  const auto centre = [&](std::uint32_t thing) {
    return Eigen::Vector3f(0.5F * (bounds[thing].low + bounds[thing].high));
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    all.include(bounds[order_[i]]);
    const Eigen::Vector3f c = centre(order_[i]);
    centres.include({c, c});
  }
  nodes_[node].low = all.low.array() - kPad_m;
  nodes_[node].high = all.high.array() + kPad_m;
  const auto make_leaf = [&] {
    nodes_[node].first = first;
    nodes_[node].count = static_cast<std::uint16_t>(count);
  };
  if (count <= kLeaf || (depth >= kMaxDepth && count < 65536)) {
    make_leaf();
    return;
  }
  const Eigen::Vector3f size = centres.high - centres.low;
  const auto bin_of = [&](std::uint32_t thing, int axis) {
    const float share = (centre(thing)[axis] - centres.low[axis]) / size[axis];
    return std::clamp(static_cast<int>(share * kBins), 0, kBins - 1);
  };
  Cut cut;
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] < 1e-5F) {
      continue;
    }
    std::array<Bin, kBins> bins{};
    for (std::uint32_t i = first; i < first + count; ++i) {
      Bin& bin = bins[static_cast<std::size_t>(bin_of(order_[i], axis))];
      bin.bounds.include(bounds[order_[i]]);
      ++bin.count;
    }
    std::array<float, kBins> above{};
    Bin sum;
    for (std::size_t bin = kBins - 1; bin > 0; --bin) {
      sum.bounds.include(bins[bin].bounds);
      sum.count += bins[bin].count;
      above[bin] = area(sum.bounds) * static_cast<float>(sum.count);
    }
    sum = {};
    for (std::size_t bin = 1; bin < kBins; ++bin) {
      sum.bounds.include(bins[bin - 1].bounds);
      sum.count += bins[bin - 1].count;
      const float cost = area(sum.bounds) * static_cast<float>(sum.count) + above[bin];
      if (sum.count > 0 && sum.count < count && cost < cut.cost) {
        cut = {axis, static_cast<int>(bin), cost};
      }
    }
  }
  std::uint32_t left = count / 2;  // things in one place: any halves will do
  if (cut.axis >= 0) {
    const auto begin = order_.begin() + first;
    const auto middle =
        std::partition(begin, begin + count, [&](std::uint32_t thing) { return bin_of(thing, cut.axis) < cut.bin; });
    left = static_cast<std::uint32_t>(middle - begin);
  } else if (count <= 16) {
    make_leaf();
    return;
  }
  const auto child = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  nodes_.emplace_back();
  nodes_[node].first = child;
  nodes_[node].axis = static_cast<std::uint16_t>(std::max(cut.axis, 0));
  split(child, bounds, first, left, depth + 1);
  split(child + 1, bounds, first + left, count - left, depth + 1);
}

}  // namespace slamd::simulate
