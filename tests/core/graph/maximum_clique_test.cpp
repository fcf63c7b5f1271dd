#include "core/graph/maximum_clique.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <memory>
#include <vector>

#include "random_poses.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::graph {
namespace {

using Edges = std::vector<std::vector<bool>>;

/// Joins each pair with a probability.
Edges draw_edges(Draw& draw, std::size_t n, double probability) {
  Edges edges(n, std::vector<bool>(n, false));
  for (std::size_t u = 0; u < n; ++u) {
    for (std::size_t v = 0; v < u; ++v) {
      edges[u][v] = edges[v][u] = draw.uniform(0.0, 1.0) < probability;
    }
  }
  return edges;
}

void tell(const Edges& edges, MaximumClique& sut) {
  sut.reset(edges.size());
  for (std::size_t u = 0; u < edges.size(); ++u) {
    for (std::size_t v = 0; v < u; ++v) {
      if (edges[u][v]) {
        sut.join(u, v);
      }
    }
  }
}

bool is_clique(const Edges& edges, const Clique& clique) {
  for (std::size_t u = 0; u < edges.size(); ++u) {
    for (std::size_t v = 0; v < u; ++v) {
      if (clique.vertices[u] && clique.vertices[v] && !edges[u][v]) {
        return false;
      }
    }
  }
  return clique.vertices.count() == clique.size;
}

std::size_t brute_force(const Edges& edges) {
  std::size_t best = 0;
  for (std::uint32_t set = 0; set < (1U << edges.size()); ++set) {
    Clique clique;
    clique.vertices = VertexSet(set);
    clique.size = clique.vertices.count();
    best = clique.size > best && is_clique(edges, clique) ? clique.size : best;
  }
  return best;
}

TEST(MaximumClique, IsAsGreatAsBruteForceFinds) {
  const auto sut = std::make_unique<MaximumClique>();
  EXPECT_TRUE(rc::check([&] {
    Draw draw(*rc::gen::arbitrary<std::uint64_t>());
    const Edges edges = draw_edges(draw, static_cast<std::size_t>(*rc::gen::inRange(0, 12)), draw.uniform(0.1, 0.9));
    tell(edges, *sut);

    const Clique found = sut->find();

    RC_ASSERT(found.exact);
    RC_ASSERT(is_clique(edges, found));
    RC_ASSERT(found.size == brute_force(edges));
  }));
}

TEST(MaximumClique, FindsAPlantedOneAmongManyVertices) {
  const auto sut = std::make_unique<MaximumClique>();
  Draw draw(1);
  Edges edges = draw_edges(draw, kMaxCliqueVertices, 0.2);
  for (std::size_t u = 0; u < kMaxCliqueVertices; u += 8) {
    for (std::size_t v = 0; v < u; v += 8) {
      edges[u][v] = edges[v][u] = true;
    }
  }
  tell(edges, *sut);

  const Clique found = sut->find();

  EXPECT_TRUE(found.exact);
  EXPECT_EQ(found.size, kMaxCliqueVertices / 8);
  EXPECT_TRUE(found.vertices[0] && found.vertices[8]);
}

TEST(MaximumClique, GivesTheGreedyOneOrBetterWhenItsBudgetIsUsedUp) {
  const auto sut = std::make_unique<MaximumClique>(50);
  Draw draw(2);
  const Edges edges = draw_edges(draw, 200, 0.7);
  tell(edges, *sut);

  const Clique found = sut->find();

  EXPECT_FALSE(found.exact);
  EXPECT_TRUE(is_clique(edges, found));
  EXPECT_GE(found.size, sut->greedy().size);
}

TEST(MaximumClique, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const auto sut = std::make_unique<MaximumClique>();
  Draw draw(3);
  tell(draw_edges(draw, 100, 0.5), *sut);

  EXPECT_EQ(support::count_allocations([&] { sut->find(); }), 0U);
}

}  // namespace
}  // namespace slamd::graph
