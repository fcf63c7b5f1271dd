#include "core/graph/normal_equations.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <map>
#include <utility>
#include <vector>

#include "random_poses.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::graph {
namespace {

/// A random system, told to the sparse equations and to a dense matrix alike.
struct Both {
  NormalEquations sparse;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<Eigen::Index> offset;  // of the dense one's blocks

  Both(Draw& draw, const std::vector<int>& dimensions, const std::vector<std::pair<std::size_t, std::size_t>>& couplings)
      : sparse({dimensions.size(), couplings.size(), 6, 100'000}) {
    sparse.clear_structure();
    Eigen::Index n = 0;
    for (int d : dimensions) {
      sparse.add_block(d);
      offset.push_back(n);
      n += d;
    }
    for (const auto& [u, v] : couplings) {
      sparse.couple(u, v);
    }
    EXPECT_TRUE(sparse.analyse());
    H = Eigen::MatrixXd::Zero(n, n);
    g = Eigen::VectorXd::Zero(n);
    for (std::size_t k = 0; k < couplings.size(); ++k) {
      const auto [u, v] = couplings[k];
      const Eigen::MatrixXd block = 0.1 * Eigen::MatrixXd::NullaryExpr(dimensions[u], dimensions[v], [&] { return draw.normal(); });
      sparse.add_coupling(k, block);
      H.block(offset[u], offset[v], dimensions[u], dimensions[v]) += block;
      H.block(offset[v], offset[u], dimensions[v], dimensions[u]) += block.transpose();
    }
    for (std::size_t u = 0; u < dimensions.size(); ++u) {
      const Eigen::MatrixXd diagonal = draw.positive<6>(10.0).topLeftCorner(dimensions[u], dimensions[u]);
      const Eigen::VectorXd right = draw.vector(1.0).replicate<2, 1>().head(dimensions[u]);
      sparse.add_diagonal(u, diagonal);
      sparse.add_gradient(u, right);
      H.block(offset[u], offset[u], dimensions[u], dimensions[u]) += diagonal;
      g.segment(offset[u], dimensions[u]) += right;
    }
  }

  /// The greatest difference between the two solutions.
  double difference(const Eigen::VectorXd& x, const std::vector<int>& dimensions) const {
    double out = 0.0;
    for (std::size_t u = 0; u < dimensions.size(); ++u) {
      const Eigen::VectorXd step = dimensions[u] == 6 ? Eigen::VectorXd(sparse.step<6>(u)) : Eigen::VectorXd(sparse.step<4>(u));
      out = std::max(out, (step - x.segment(offset[u], dimensions[u])).cwiseAbs().maxCoeff());
    }
    return out;
  }
};

TEST(NormalEquations, SolveAsADenseMatrixDoes) {
  EXPECT_TRUE(rc::check([] {
    Draw draw(*rc::gen::arbitrary<std::uint64_t>());
    const std::size_t n = static_cast<std::size_t>(*rc::gen::inRange(1, 30));
    std::vector<int> dimensions(n, 6);
    dimensions.push_back(4);
    std::vector<std::pair<std::size_t, std::size_t>> couplings;
    for (std::size_t i = 1; i < n; ++i) {
      couplings.emplace_back(i - 1, i);
    }
    for (std::size_t k = 0; k < n; ++k) {
      const auto u = static_cast<std::size_t>(draw.uniform(0.0, static_cast<double>(n)));
      couplings.emplace_back(n, u);  // later first: transposed where it is eliminated earlier; some twice
      if (u + 1 < n) {
        couplings.emplace_back(n - 1, u);
      }
    }
    Both both(draw, dimensions, couplings);
    const double lambda = draw.uniform(0.0, 1.0);
    Eigen::MatrixXd damped = both.H;
    damped.diagonal() *= 1.0 + lambda;

    RC_ASSERT(both.sparse.solve(lambda));

    RC_ASSERT(both.difference(damped.ldlt().solve(both.g), dimensions) < 1e-9);
  }));
}

TEST(NormalEquations, CountTheEntriesOfTheFactorBeforeTheyAreMade) {
  // An arrow: eliminated from its tips it has no fill; each tip has 15 below its own diagonal and 36 towards the hub.
  Draw draw(1);
  std::vector<std::pair<std::size_t, std::size_t>> couplings;
  for (std::size_t k = 1; k < 10; ++k) {
    couplings.emplace_back(0, k);
  }

  const Both both(draw, std::vector<int>(10, 6), couplings);

  EXPECT_EQ(both.sparse.factor_entries(), 10U * 15U + 9U * 36U);
}

TEST(NormalEquations, RefuseAStructureWhoseFactorDoesNotFit) {
  NormalEquations sut({3, 3, 6, 15 * 3 + 2 * 36});
  sut.clear_structure();
  for (int k = 0; k < 3; ++k) {
    sut.add_block(6);
  }
  sut.couple(0, 1);
  sut.couple(1, 2);
  EXPECT_TRUE(sut.analyse());

  sut.couple(0, 2);

  EXPECT_FALSE(sut.analyse());
}

TEST(NormalEquations, SayWhatIsNotPositive) {
  Draw draw(2);
  Both both(draw, {6, 6}, {{0, 1}});
  EXPECT_TRUE(both.sparse.solve(0.0));

  both.sparse.clear_values();

  EXPECT_FALSE(both.sparse.solve(0.0));
}

TEST(NormalEquations, TakeOnlyTheWorkArraysOfEigensFactorisation) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  constexpr std::size_t kBlocks = 4'000;  // so many that its work arrays are above Eigen's limit for the stack
  const Eigen::Matrix<double, 6, 6> one = Eigen::Matrix<double, 6, 6>::Identity();
  NormalEquations sut({kBlocks, kBlocks, 6, 300'000});
  sut.clear_structure();
  for (std::size_t k = 0; k < kBlocks; ++k) {
    sut.add_block(6);
  }
  for (std::size_t k = 1; k < kBlocks; ++k) {
    sut.couple(k - 1, k);
  }
  ASSERT_TRUE(sut.analyse());
  for (std::size_t k = 0; k < kBlocks; ++k) {
    sut.add_diagonal(k, one);
  }
  ASSERT_TRUE(sut.solve(0.0));  // its diagonal has its size now

  const std::size_t count = support::count_allocations([&] {
    sut.clear_values();
    for (std::size_t k = 0; k < kBlocks; ++k) {
      sut.add_diagonal(k, one);
    }
    sut.add_coupling(7, (0.1 * one).eval());
    sut.solve(0.0);
  });

  EXPECT_LE(count, 3U);
}

}  // namespace
}  // namespace slamd::graph
