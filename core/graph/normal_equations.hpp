// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/graph/residual_blocks.hpp"

/// Private to core/graph: JᵀJ of a graph, assembled block by block straight from the factors' Jacobians.
namespace kinemap::graph {

/// Where a variable's tangent sits among the scalar columns; size 0: it has none (inactive landmark, fixed touching
/// point).
struct ColumnRange {
  int start = 0;
  int size = 0;
};

struct NormalEquations {
  Eigen::SparseMatrix<double> upper;  ///< upper triangle of P·JᵀJ·Pᵀ, P a fill-reducing order of whole variables
  std::vector<ColumnRange> columns;   ///< by VariableId, in the permuted order
};

/// nullopt when a variable has no factor at all or a factor cannot be evaluated. `graph` without fault (see check.hpp).
std::optional<NormalEquations> assemble_normal_equations(const Graph& graph);

/// Factorises an upper triangle in the order that it has. (Asked to keep the order, Eigen 3.4 still copies the matrix
/// twice: it compares the ordering with one for another type of index.)
class Cholesky : public Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Upper> {
 public:
  explicit Cholesky(const Eigen::SparseMatrix<double>& upper) {
    analyzePattern_preordered(upper, false);
    factorize_preordered<false>(upper);
  }
};

/// P·JᵀJ·Pᵀ = L·Lᵀ.
struct Factorisation {
  std::vector<ColumnRange> columns;  ///< as of NormalEquations
  std::unique_ptr<const Cholesky> cholesky;

  [[nodiscard]] const Eigen::SparseMatrix<double>& L() const { return cholesky->matrixL().nestedExpression(); }
};

/// nullopt when the graph has a fault or the system is singular (a variable without factors, no gauge).
std::optional<Factorisation> factorise(const Graph& graph);

}  // namespace kinemap::graph
