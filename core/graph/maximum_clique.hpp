#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

#include "core/base/bounded_vector.hpp"

namespace slamd::graph {

/// Up to so many vertices.
inline constexpr std::size_t kMaxCliqueVertices = 256;

using VertexSet = std::bitset<kMaxCliqueVertices>;

/// A clique, with whether it is proved that none is greater.
struct Clique {
  VertexSet vertices;
  std::size_t size = 0;
  bool exact = true;
};

/// Finds the greatest set of vertices that are all joined with each other.
///
/// Branch and bound: a branch is given up when even a colour for each candidate's class would not make it greater than the
/// best so far. Starts from the greedy clique; when the budget of branches is used up the best so far is given
/// back, never less than the greedy one, and `exact` is false.
/// Source: [Tomita03] MCQ: greedy colouring as bound; the greedy start takes the vertex with most joined candidates.
/// Of several greatest cliques the same one is found each time. Real-time: no allocation.
class MaximumClique {
 public:
  explicit MaximumClique(std::size_t budget = 20'000);

  /// Begins a graph of so many vertices, none joined.
  void reset(std::size_t vertices);

  void join(std::size_t u, std::size_t v);

  Clique find();

  /// The greedy clique alone.
  Clique greedy() const;

 private:
  void expand(const VertexSet& candidates, std::size_t depth);

  std::size_t budget_;
  std::size_t vertices_ = 0;
  std::size_t branches_ = 0;
  std::array<VertexSet, kMaxCliqueVertices> joined_{};
  Clique best_;

  // scratch, sized once: the candidates of each depth in order of their colours
  struct Coloured {
    std::uint16_t vertex = 0;
    std::uint16_t colour = 0;
  };
  BoundedVector<Coloured> coloured_;
  VertexSet current_;
};

}  // namespace slamd::graph
