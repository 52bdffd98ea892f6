// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>

#include "core/graph/graph.hpp"

namespace kinemap::graph {

/// Refers to one variable of a graph.
struct Variable {
  enum class Kind : std::uint8_t { Pose, Landmark, Touch } kind = Kind::Pose;
  std::size_t index = 0;
};

/// Joint marginal covariances at the graph's current values, from one sparse Cholesky factorisation of JᵀJ (robust
/// weights included). Blocks are in the variables' tangent: poses 6, landmarks `dimension(kind)`, touching points 3 (0
/// columns when fixed).
class Marginals {
 public:
  /// nullopt when the system is singular (a variable without factors, no gauge).
  static std::optional<Marginals> compute(const Graph& graph);
  ~Marginals();
  Marginals(Marginals&&) noexcept;
  Marginals& operator=(Marginals&&) noexcept;

  /// Joint covariance of the variables, stacked in the given order.
  [[nodiscard]] Eigen::MatrixXd joint(std::span<const Variable> variables) const;

 private:
  class Impl;
  explicit Marginals(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinemap::graph
