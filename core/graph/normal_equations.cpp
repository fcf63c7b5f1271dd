#include "core/graph/normal_equations.hpp"

#include <algorithm>
#include <new>
#include <tuple>

#include <Eigen/OrderingMethods>

#include "core/base/assert.hpp"

namespace slamd::graph {

NormalEquations::NormalEquations(const NormalEquationsCapacity& capacity)
    : capacity_(capacity),
      dimensions_(capacity.blocks),
      couplings_(capacity.couplings),
      places_(capacity.couplings),
      entries_(capacity.couplings),
      block_at_(capacity.blocks),
      position_of_(capacity.blocks),
      offset_(capacity.blocks),
      gradient_memory_(static_cast<Eigen::Index>(capacity.blocks * capacity.block_size)),
      solution_memory_(gradient_memory_.size()),
      parent_(capacity.blocks),
      mark_(capacity.blocks),
      column_begin_(capacity.blocks + 1) {
  const std::size_t n = capacity.block_size;
  H_.reserve(static_cast<Eigen::Index>(capacity.blocks * n * (n + 1) / 2 + capacity.couplings * n * n));
  factorisation_.reserve(capacity.factor_entries);
}

void NormalEquations::clear_structure() {
  dimensions_.clear();
  couplings_.clear();
  dimension_ = 0;
}

std::size_t NormalEquations::add_block(int dimension) {
  dimensions_.push_back(dimension);
  dimension_ += static_cast<std::size_t>(dimension);
  return dimensions_.size() - 1;
}

std::size_t NormalEquations::couple(std::size_t u, std::size_t v) {
  SLAMD_ASSERT(u != v && u < dimensions_.size() && v < dimensions_.size());
  couplings_.push_back({static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v)});
  return couplings_.size() - 1;
}

void NormalEquations::order() {
  const std::size_t n = dimensions_.size();
  // The whole symmetric pattern, each diagonal entry included, as the ordering wants it.
  column_begin_.resize(0);
  column_begin_.resize(n + 1);
  for (std::size_t u = 0; u < n; ++u) {
    column_begin_[u + 1] = 1;
  }
  for (const Coupling& c : couplings_) {
    ++column_begin_[c.u + 1];
    ++column_begin_[c.v + 1];
  }
  for (std::size_t u = 0; u < n; ++u) {
    column_begin_[u + 1] += column_begin_[u];
  }
  Sparse pattern(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  pattern.resizeNonZeros(column_begin_[n]);
  std::copy_n(column_begin_.begin(), n + 1, pattern.outerIndexPtr());
  int* inner = pattern.innerIndexPtr();
  std::fill_n(pattern.valuePtr(), column_begin_[n], 1.0);
  for (std::size_t u = 0; u < n; ++u) {
    inner[column_begin_[u]++] = static_cast<int>(u);
  }
  for (const Coupling& c : couplings_) {
    inner[column_begin_[c.u]++] = static_cast<int>(c.v);
    inner[column_begin_[c.v]++] = static_cast<int>(c.u);
  }
  // What was coupled twice stands twice: the ordering must not see it so.
  int kept = 0;
  mark_.resize(0);
  mark_.resize(n);
  for (std::size_t u = 0; u < n; ++u) {
    const int begin = pattern.outerIndexPtr()[u];
    const int end = column_begin_[u];
    pattern.outerIndexPtr()[u] = kept;
    for (int k = begin; k < end; ++k) {
      if (mark_[static_cast<std::size_t>(inner[k])] != u + 1) {
        mark_[static_cast<std::size_t>(inner[k])] = static_cast<std::uint32_t>(u + 1);
        inner[kept++] = inner[k];
      }
    }
  }
  pattern.outerIndexPtr()[n] = kept;
  pattern.resizeNonZeros(kept);

  block_at_.resize(n);
  position_of_.resize(n);
  if (n > 2) {  // the ordering reads beyond smaller ones
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::internal::minimum_degree_ordering(pattern, permutation);
    for (std::size_t k = 0; k < n; ++k) {
      block_at_[k] = static_cast<std::uint32_t>(permutation.indices()[static_cast<Eigen::Index>(k)]);
    }
  } else {
    for (std::size_t k = 0; k < n; ++k) {
      block_at_[k] = static_cast<std::uint32_t>(k);
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    position_of_[block_at_[k]] = static_cast<std::uint32_t>(k);
  }
}

std::size_t NormalEquations::count_factor_entries() {
  // The elimination tree over blocks, row by row: each step up the tree is a block of L. [Davis06] 4.1.
  const std::size_t n = dimensions_.size();
  parent_.resize(0);
  parent_.resize(n);
  mark_.resize(0);
  mark_.resize(n);
  std::size_t entries = 0;
  std::size_t next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    parent_[k] = -1;
    mark_[k] = static_cast<std::uint32_t>(k);
    const auto rows = static_cast<std::size_t>(dimensions_[block_at_[k]]);
    entries += rows * (rows - 1) / 2;
    for (; next < entries_.size() && entries_[next].column == k; ++next) {
      for (std::size_t i = entries_[next].row; mark_[i] != k; i = static_cast<std::size_t>(parent_[i])) {
        if (parent_[i] == -1) {
          parent_[i] = static_cast<int>(k);
        }
        mark_[i] = static_cast<std::uint32_t>(k);
        entries += rows * static_cast<std::size_t>(dimensions_[block_at_[i]]);
      }
    }
  }
  return entries;
}

bool NormalEquations::analyse() {
  order();
  entries_.clear();
  for (std::size_t k = 0; k < couplings_.size(); ++k) {
    const std::uint32_t a = position_of_[couplings_[k].u];
    const std::uint32_t b = position_of_[couplings_[k].v];
    entries_.push_back({std::max(a, b), std::min(a, b), static_cast<std::uint32_t>(k)});
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.column, a.row, a.coupling) < std::tie(b.column, b.row, b.coupling);
  });
  factor_entries_ = count_factor_entries();
  if (factor_entries_ > capacity_.factor_entries) {
    return false;
  }
  lay_out();
  factorisation_.analyzePattern(H_);
  return true;
}

void NormalEquations::lay_out() {
  const std::size_t n = dimensions_.size();
  offset_.resize(n);
  int scalars = 0;
  for (std::size_t k = 0; k < n; ++k) {
    offset_[block_at_[k]] = scalars;
    scalars += dimensions_[block_at_[k]];
  }
  H_.resize(scalars, scalars);
  std::size_t total = 0;
  std::size_t next = 0;
  places_.resize(couplings_.size());
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t block = block_at_[k];
    int above = 0;
    for (std::size_t previous = n; next < entries_.size() && entries_[next].column == k; ++next) {
      const Entry& entry = entries_[next];
      const int rows = dimensions_[block_at_[entry.row]];
      above += entry.row == previous ? 0 : rows;
      previous = entry.row;
      places_[entry.coupling] = {offset_[block], above - rows, couplings_[entry.coupling].v != block};
    }
    for (int j = 0; j < dimensions_[block]; ++j) {
      H_.outerIndexPtr()[offset_[block] + j] = static_cast<int>(total);
      total += static_cast<std::size_t>(above + j + 1);
    }
  }
  H_.outerIndexPtr()[scalars] = static_cast<int>(total);
  H_.resizeNonZeros(static_cast<Eigen::Index>(total));
  int* inner = H_.innerIndexPtr();
  next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t block = block_at_[k];
    const std::size_t begin = next;
    for (int j = 0; j < dimensions_[block]; ++j) {
      std::size_t previous = n;
      for (next = begin; next < entries_.size() && entries_[next].column == k; ++next) {
        if (entries_[next].row != previous) {
          const std::uint32_t other = block_at_[entries_[next].row];
          for (int i = 0; i < dimensions_[other]; ++i) {
            *inner++ = offset_[other] + i;
          }
          previous = entries_[next].row;
        }
      }
      for (int i = 0; i <= j; ++i) {
        *inner++ = offset_[block] + i;
      }
    }
  }
  values_ = H_.valuePtr();
  outer_ = H_.outerIndexPtr();
  // A view of another length on the same memory.
  new (&gradient_) Eigen::Map<Eigen::VectorXd>(gradient_memory_.data(), scalars);
  new (&solution_) Eigen::Map<Eigen::VectorXd>(solution_memory_.data(), scalars);
  clear_values();
}

void NormalEquations::clear_values() {
  std::fill_n(values_, H_.nonZeros(), 0.0);
  gradient_.setZero();
}

bool NormalEquations::solve(double lambda) {
  factorisation_.setShift(0.0, 1.0 + lambda);
  factorisation_.factorize(H_);
  if (!factorisation_.is_positive()) {
    return false;
  }
  factorisation_._solve_impl(gradient_, solution_);
  return true;
}

}  // namespace slamd::graph
