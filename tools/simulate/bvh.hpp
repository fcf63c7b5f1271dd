#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/simulate/surfaces.hpp"

namespace slamd::simulate {

/// A tree of bounds over things in space, so that a ray meets few of them. Built with binned surface-area costs.
/// Source: Wald (2007), "On fast construction of SAH-based bounding volume hierarchies".
class Bvh {
 public:
  /// Builds the tree; things are known by their index in `bounds`.
  void build(std::span<const Bounds> bounds);

  /// Calls try_thing(index) for the things that the ray may meet before `range` m, the nearer ones first; the callee
  /// shortens `range`.
  template <typename TryThing>
  void visit(const Ray& ray, const double& range, TryThing&& try_thing) const;

  /// The things in the order of the leaves: neighbours in space are neighbours here.
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  struct Node {
    Eigen::Vector3f low;
    Eigen::Vector3f high;
    std::uint32_t first = 0;   // leaf: in order_; otherwise: the left child, the right one follows it
    std::uint16_t count = 0;   // of things; 0: not a leaf
    std::uint16_t axis = 0;    // along which the children lie
  };

  void split(std::uint32_t node, std::span<const Bounds> bounds, std::uint32_t first, std::uint32_t count, int depth);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <typename TryThing>
void Bvh::visit(const Ray& ray, const double& range, TryThing&& try_thing) const {
  if (nodes_.empty()) {
    return;
  }
  const Eigen::Array3f origin = ray.origin.cast<float>().array();
  Eigen::Array3f inverse;
  bool backward[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis];
    inverse[axis] = static_cast<float>(1.0 / (std::abs(d) > 1e-9 ? d : (d < 0.0 ? -1e-9 : 1e-9)));
    backward[axis] = d < 0.0;
  }
  struct Entry {
    std::uint32_t node;
    float enter;
  };
  Entry stack[64];
  int size = 0;
  const auto enter_of = [&](const Node& node) {
    const float x_near = ((backward[0] ? node.high.x() : node.low.x()) - origin.x()) * inverse.x();
    const float x_far = ((backward[0] ? node.low.x() : node.high.x()) - origin.x()) * inverse.x();
    const float y_near = ((backward[1] ? node.high.y() : node.low.y()) - origin.y()) * inverse.y();
    const float y_far = ((backward[1] ? node.low.y() : node.high.y()) - origin.y()) * inverse.y();
    const float z_near = ((backward[2] ? node.high.z() : node.low.z()) - origin.z()) * inverse.z();
    const float z_far = ((backward[2] ? node.low.z() : node.high.z()) - origin.z()) * inverse.z();
    const float near = std::max(std::max(x_near, y_near), std::max(z_near, 0.0F));
    const float far = std::min(std::min(x_far, y_far), z_far);
    return near <= far * 1.000002F ? near : 1e30F;
  };
  const auto limit = [&] { return static_cast<float>(range) + 1e-3F; };
  const float root_enter = enter_of(nodes_[0]);
  if (root_enter < limit()) {
    stack[size++] = {0, root_enter};
  }
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.enter >= limit()) {
      continue;
    }
    const Node* node = &nodes_[entry.node];
    while (node->count == 0) {
      const std::uint32_t near_child = node->first + (backward[node->axis] ? 1U : 0U);
      const std::uint32_t far_child = node->first + (backward[node->axis] ? 0U : 1U);
      const float near_enter = enter_of(nodes_[near_child]);
      const float far_enter = enter_of(nodes_[far_child]);
      const bool near_hit = near_enter < limit();
      const bool far_hit = far_enter < limit();
      if (near_hit && far_hit) {
        stack[size++] = {far_child, far_enter};
      }
      if (!near_hit && !far_hit) {
        node = nullptr;
        break;
      }
      node = &nodes_[near_hit ? near_child : far_child];
    }
    if (node != nullptr) {
      for (std::uint32_t i = 0; i < node->count; ++i) {
        try_thing(order_[node->first + i]);
      }
    }
  }
}

}  // namespace slamd::simulate
