#include "core/graph/maximum_clique.hpp"

#include "core/base/assert.hpp"

namespace slamd::graph {

MaximumClique::MaximumClique(std::size_t budget)
    : budget_(budget), coloured_(kMaxCliqueVertices * (kMaxCliqueVertices + 1) / 2) {}

void MaximumClique::reset(std::size_t vertices) {
  SLAMD_ASSERT(vertices <= kMaxCliqueVertices);
  vertices_ = vertices;
  for (std::size_t v = 0; v < vertices; ++v) {
    joined_[v].reset();
  }
}

void MaximumClique::join(std::size_t u, std::size_t v) {
  SLAMD_ASSERT(u != v && u < vertices_ && v < vertices_);
  joined_[u].set(v);
  joined_[v].set(u);
}

Clique MaximumClique::greedy() const {
  Clique clique;
  VertexSet candidates;
  for (std::size_t v = 0; v < vertices_; ++v) {
    candidates.set(v);
  }
  while (candidates.any()) {
    std::size_t chosen = vertices_;
    std::size_t most = 0;
    for (std::size_t v = 0; v < vertices_; ++v) {
      if (candidates[v]) {
        const std::size_t joined = (candidates & joined_[v]).count();
        if (chosen == vertices_ || joined > most) {
          chosen = v;
          most = joined;
        }
      }
    }
    clique.vertices.set(chosen);
    ++clique.size;
    candidates &= joined_[chosen];
  }
  clique.exact = false;
  return clique;
}

Clique MaximumClique::find() {
  best_ = greedy();
  branches_ = 0;
  coloured_.clear();
  current_.reset();
  VertexSet all;
  for (std::size_t v = 0; v < vertices_; ++v) {
    all.set(v);
  }
  expand(all, 0);
  best_.exact = branches_ <= budget_;
  return best_;
}

void MaximumClique::expand(const VertexSet& candidates, std::size_t depth) {
  if (candidates.none()) {
    if (depth > best_.size) {
      best_.vertices = current_;
      best_.size = depth;
    }
    return;
  }
  // Vertices of one colour are not joined, so a clique has at most one of each.
  const std::size_t begin = coloured_.size();
  VertexSet uncoloured = candidates;
  for (std::uint16_t colour = 1; uncoloured.any(); ++colour) {
    VertexSet free = uncoloured;
    for (std::size_t v = 0; v < vertices_ && free.any(); ++v) {
      if (free[v]) {
        coloured_.push_back({static_cast<std::uint16_t>(v), colour});
        uncoloured.reset(v);
        free.reset(v);
        free &= ~joined_[v];
      }
    }
  }
  VertexSet remaining = candidates;
  for (std::size_t k = coloured_.size(); k-- > begin;) {
    if (depth + coloured_[k].colour <= best_.size || ++branches_ > budget_) {
      break;
    }
    const std::size_t v = coloured_[k].vertex;
    current_.set(v);
    expand(remaining & joined_[v], depth + 1);
    current_.reset(v);
    remaining.reset(v);
  }
  coloured_.resize(begin);
}

}  // namespace slamd::graph
