#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "core/base/bounded_vector.hpp"

namespace slamd::graph {

/// The sizes that all memory follows from.
struct NormalEquationsCapacity {
  std::size_t blocks = 0;           // variables
  std::size_t couplings = 0;        // factors between two variables
  std::size_t block_size = 6;       // the greatest dimension of a variable
  std::size_t factor_entries = 0;   // below the diagonal of L
};

/// The symmetric, block-sparse system H x = g of Gauss–Newton: filled in place, block by block, and solved by a sparse LDLᵀ.
///
/// The structure is told once and analysed once: blocks are ordered by approximate minimum degree (on blocks, not on
/// scalars: 36 times less to order), the upper triangle is laid out in that order, and each coupling learns where
/// its values stand. From then on an iteration writes values only.
/// Source: [Davis06] 4 and 6; Eigen's AMDOrdering and SimplicialLDLT.
/// Memory: values, L and the couplings are sized once, by the capacity. Eigen's ordering and analysis take scratch and
/// return it, once a structure; its numeric factorisation takes three work arrays of the system's dimension and returns them.
class NormalEquations {
 public:
  explicit NormalEquations(const NormalEquationsCapacity& capacity);

  /// Begins a new structure.
  void clear_structure();

  /// Adds a variable and returns its index.
  std::size_t add_block(int dimension);

  /// Tells that a factor ties two variables, and returns the coupling's index. The same two may be coupled again.
  std::size_t couple(std::size_t u, std::size_t v);

  /// Orders and lays out. Returns false, with nothing to solve, where L would have more entries than the capacity.
  bool analyse();

  std::size_t blocks() const { return dimensions_.size(); }
  std::size_t dimension() const { return dimension_; }
  std::size_t factor_entries() const { return factor_entries_; }

  /// Sets all values to zero; the structure stays.
  void clear_values();

  /// Adds to the diagonal block of u (only its upper triangle is read).
  template <typename Derived>
  void add_diagonal(std::size_t u, const Eigen::MatrixBase<Derived>& block) {
    const Eigen::Index first = offset_[u];
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      double* column = values_ + outer_[first + j + 1] - (j + 1);
      for (Eigen::Index i = 0; i <= j; ++i) {
        column[i] += block(i, j);
      }
    }
  }

  /// Adds a coupling's block: rows of u, columns of v, as couple was told them.
  template <typename Derived>
  void add_coupling(std::size_t coupling, const Eigen::MatrixBase<Derived>& block) {
    const Place& place = places_[coupling];
    if (place.transposed) {
      add_upper(place, block.transpose());
    } else {
      add_upper(place, block);
    }
  }

  /// Adds to the right side.
  template <typename Derived>
  void add_gradient(std::size_t u, const Eigen::MatrixBase<Derived>& g) {
    gradient_.segment(offset_[u], g.size()) += g;
  }

  /// Solves (H + λ diag H) x = g. Returns false where the system is not positive definite.
  bool solve(double lambda);

  /// Returns the solution's part of a variable.
  template <int kDimension>
  Eigen::Matrix<double, kDimension, 1> step(std::size_t u) const {
    return solution_.segment<kDimension>(offset_[u]);
  }

 private:
  /// Where a coupling's block stands: in columns first_column …, after `above` rows of other blocks in each.
  struct Place {
    Eigen::Index first_column = 0;
    int above = 0;
    bool transposed = false;
  };

  struct Coupling {
    std::uint32_t u = 0;
    std::uint32_t v = 0;
  };

  /// One block of the upper triangle: column, row (in the order of elimination) and a coupling that it serves.
  struct Entry {
    std::uint32_t column = 0;
    std::uint32_t row = 0;
    std::uint32_t coupling = 0;
  };

  using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

  /// Eigen's factorisation of a matrix that is in order already, read where it stands, with L's memory taken in advance.
  class Factorisation : public Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>> {
   public:
    void reserve(std::size_t entries) { m_matrix.data().reserve(static_cast<Eigen::Index>(entries)); }
    bool is_positive() const { return info() == Eigen::Success && m_diag.minCoeff() > 0.0; }
  };

  void order();
  std::size_t count_factor_entries();
  void lay_out();

  template <typename Derived>
  void add_upper(const Place& place, const Eigen::MatrixBase<Derived>& block) {
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      double* column = values_ + outer_[place.first_column + j] + place.above;
      for (Eigen::Index i = 0; i < block.rows(); ++i) {
        column[i] += block(i, j);
      }
    }
  }

  NormalEquationsCapacity capacity_;
  BoundedVector<int> dimensions_;
  BoundedVector<Coupling> couplings_;
  BoundedVector<Place> places_;
  BoundedVector<Entry> entries_;
  BoundedVector<std::uint32_t> block_at_;     // by place in the order of elimination
  BoundedVector<std::uint32_t> position_of_;  // its inverse
  BoundedVector<int> offset_;                 // of a block's first scalar
  std::size_t dimension_ = 0;
  std::size_t factor_entries_ = 0;

  Sparse H_;
  double* values_ = nullptr;
  const int* outer_ = nullptr;
  Factorisation factorisation_;
  Eigen::VectorXd gradient_memory_;
  Eigen::VectorXd solution_memory_;
  Eigen::Map<Eigen::VectorXd> gradient_{nullptr, 0};
  Eigen::Map<Eigen::VectorXd> solution_{nullptr, 0};

  // scratch, sized once
  BoundedVector<int> parent_;
  BoundedVector<std::uint32_t> mark_;
  BoundedVector<int> column_begin_;
};

}  // namespace slamd::graph
