// SPDX-License-Identifier: Apache-2.0
#include "core/graph/normal_equations.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <array>
#include <numeric>

#include "core/graph/check.hpp"
#include "core/graph/linearised.hpp"

namespace kinemap::graph {
namespace {

std::vector<int> tangent_sizes(const Graph& graph) {
  std::vector<int> sizes(graph.poses.size(), 6);
  std::fill_n(sizes.begin(), std::min(graph.first_free_pose, sizes.size()), 0);
  for (const Landmark& l : graph.landmarks) sizes.push_back(l.active ? dimension(l.kind) : 0);
  for (const TouchPoint& t : graph.touch_points) sizes.push_back(t.fixed ? 0 : 3);
  sizes.insert(sizes.end(), graph.scalars.size(), 1);
  return sizes;
}

/// Position of each variable in a minimum-degree order of the graph of variables (small: whole poses, not scalars).
std::vector<int> elimination_order(const std::vector<ResidualBlock>& blocks, const std::vector<int>& sizes) {
  const std::size_t variables = sizes.size();
  const auto constant = [&](VariableId v) { return sizes[v] == 0; };
  std::vector<Eigen::Triplet<double, int>> pairs;
  pairs.reserve(6 * blocks.size() + variables);
  for (std::size_t v = 0; v < variables; ++v) pairs.emplace_back(static_cast<int>(v), static_cast<int>(v), 1.0);
  for (const ResidualBlock& block : blocks) {
    for (int a = 0; a < block.count; ++a) {
      for (int b = 0; b < block.count; ++b) {
        if (a == b || constant(block.variables[a]) || constant(block.variables[b])) continue;
        pairs.emplace_back(static_cast<int>(block.variables[a]), static_cast<int>(block.variables[b]), 1.0);
      }
    }
  }
  const int n = static_cast<int>(variables);
  Eigen::SparseMatrix<double> pattern(n, n);
  pattern.setFromTriplets(pairs.begin(), pairs.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  std::vector<int> position(variables);  // order.indices()(k) is the variable that is eliminated k-th
  for (int k = 0; k < n; ++k) position[static_cast<std::size_t>(order.indices()(k))] = k;
  return position;
}

std::vector<ColumnRange> lay_out(const std::vector<int>& sizes, const std::vector<int>& position) {
  std::vector<std::size_t> by_position(sizes.size());
  for (std::size_t v = 0; v < sizes.size(); ++v) by_position[static_cast<std::size_t>(position[v])] = v;
  std::vector<ColumnRange> columns(sizes.size());
  int next = 0;
  for (const std::size_t v : by_position) {
    columns[v] = {next, sizes[v]};
    next += sizes[v];
  }
  return columns;
}

/// The non-zero blocks of the upper triangle: which there are, and where each lies among the values of a
/// column-compressed matrix.
class BlockPattern {
 public:
  BlockPattern(const std::vector<ResidualBlock>& blocks, const std::vector<ColumnRange>& columns) : columns_(columns) {
    std::vector<std::uint64_t> keys;
    for (const ResidualBlock& block : blocks) {
      for (int a = 0; a < block.count; ++a) {
        for (int b = 0; b < block.count; ++b) {
          const VariableId row = block.variables[a], col = block.variables[b];
          if (columns[row].size > 0 && columns[col].size > 0 && start(row) <= start(col)) keys.push_back(key(row, col));
        }
      }
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    keys_ = std::move(keys);
  }

  /// Upper triangle with zero values (the lower half of diagonal blocks is stored as well, and ignored by who reads
  /// it).
  [[nodiscard]] Eigen::SparseMatrix<double> allocate();

  /// Adds m (rows of variable `row`, columns of `col`, row not after col in the order).
  template <class Matrix>
  void add(VariableId row, VariableId col, const Matrix& m, double* values) const {
    const auto it = std::lower_bound(keys_.begin(), keys_.end(), key(row, col));
    const Place& place = places_[static_cast<std::size_t>(it - keys_.begin())];
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      Eigen::Map<Eigen::VectorXd>(values + place.offset + c * place.stride, m.rows()) += m.col(c);
    }
  }
  [[nodiscard]] int start(VariableId v) const { return columns_[v].start; }

 private:
  struct Place {
    Eigen::Index offset = 0, stride = 0;
  };
  [[nodiscard]] std::uint64_t key(VariableId row, VariableId col) const {
    return static_cast<std::uint64_t>(start(col)) << 32 | static_cast<std::uint32_t>(start(row));
  }

  const std::vector<ColumnRange>& columns_;
  std::vector<std::uint64_t> keys_;
  std::vector<Place> places_;
};

Eigen::SparseMatrix<double> BlockPattern::allocate() {
  int n = 0;
  for (const ColumnRange& c : columns_) n = std::max(n, c.start + c.size);
  std::vector<int> size_at(static_cast<std::size_t>(n), 0);
  for (const ColumnRange& c : columns_) {
    if (c.size > 0) size_at[static_cast<std::size_t>(c.start)] = c.size;
  }
  const auto row_of = [](std::uint64_t k) { return static_cast<std::size_t>(k & 0xffffffffU); };
  const auto col_of = [](std::uint64_t k) { return static_cast<std::size_t>(k >> 32); };
  Eigen::Index values = 0;
  for (const std::uint64_t k : keys_) values += Eigen::Index{size_at[row_of(k)]} * size_at[col_of(k)];

  Eigen::SparseMatrix<double> m(n, n);
  m.resizeNonZeros(values);
  places_.resize(keys_.size());
  std::vector<int> rows;  // of one block column
  Eigen::Index offset = 0;
  for (std::size_t begin = 0, end = 0; begin < keys_.size(); begin = end) {
    const std::size_t col = col_of(keys_[begin]);
    rows.clear();
    for (; end < keys_.size() && col_of(keys_[end]) == col; ++end) {
      places_[end].offset = offset + static_cast<Eigen::Index>(rows.size());
      const std::size_t row = row_of(keys_[end]);
      for (int k = 0; k < size_at[row]; ++k) rows.push_back(static_cast<int>(row) + k);
    }
    const Eigen::Index stride = static_cast<Eigen::Index>(rows.size());
    for (std::size_t k = begin; k < end; ++k) places_[k].stride = stride;
    for (int k = 0; k < size_at[col]; ++k, offset += stride) {
      m.outerIndexPtr()[col + static_cast<std::size_t>(k)] = static_cast<int>(offset);
      std::copy(rows.begin(), rows.end(), m.innerIndexPtr() + offset);
    }
  }
  m.outerIndexPtr()[n] = static_cast<int>(offset);
  std::fill_n(m.valuePtr(), offset, 0.0);
  return m;
}

/// A pivot this small against its diagonal entry is rounding: the variable is not determined.
constexpr double kSingularPivot = 1e-12;

bool regular(const Eigen::SparseMatrix<double>& L, const Eigen::SparseMatrix<double>& A) {
  for (int j = 0; j < L.cols(); ++j) {
    const double pivot = L.valuePtr()[L.outerIndexPtr()[j]];
    if (!(pivot * pivot > kSingularPivot * A.coeff(j, j))) return false;
  }
  return true;
}

}  // namespace

std::optional<NormalEquations> assemble_normal_equations(const Graph& graph) {
  Values values(graph);
  const ResidualBlocks problem(graph, values, graph.first_free_pose);
  const std::vector<int> sizes = tangent_sizes(graph);
  const std::vector<ResidualBlock>& blocks = problem.blocks;
  std::vector<bool> seen(sizes.size(), false);
  for (const ResidualBlock& block : blocks) {
    for (int k = 0; k < block.count; ++k) seen[block.variables[k]] = true;
  }
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    if (sizes[v] > 0 && !seen[v]) return std::nullopt;
  }

  NormalEquations out;
  out.columns = lay_out(sizes, elimination_order(blocks, sizes));
  BlockPattern pattern(blocks, out.columns);
  out.upper = pattern.allocate();
  Linearised linearised;
  for (const ResidualBlock& block : blocks) {
    if (!linearised.evaluate(block)) return std::nullopt;
    for (int a = 0; a < block.count; ++a) {
      if (sizes[block.variables[a]] == 0) continue;
      const auto Ja = linearised.jacobian(a, sizes[block.variables[a]]);
      for (int b = 0; b < block.count; ++b) {
        if (sizes[block.variables[b]] == 0) continue;
        if (pattern.start(block.variables[a]) > pattern.start(block.variables[b])) continue;
        const auto Jb = linearised.jacobian(b, sizes[block.variables[b]]);
        const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 7, 7> JtJ = Ja.transpose().lazyProduct(Jb);
        pattern.add(block.variables[a], block.variables[b], JtJ, out.upper.valuePtr());
      }
    }
  }
  return out;
}

std::optional<Factorisation> factorise(const Graph& graph) {
  if (find_fault(graph)) return std::nullopt;
  std::optional<NormalEquations> equations = assemble_normal_equations(graph);
  if (!equations) return std::nullopt;
  Factorisation out{std::move(equations->columns), std::make_unique<const Cholesky>(equations->upper)};
  if (out.cholesky->info() != Eigen::Success || !regular(out.L(), equations->upper)) return std::nullopt;
  return out;
}

}  // namespace kinemap::graph
