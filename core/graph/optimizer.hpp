// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/graph/graph.hpp"

namespace kinemap::graph {

struct OptimizerOptions {
  int max_iterations = 20;
  double time_budget_s = 0.0;  ///< 0: none. A budget makes results depend on the machine's speed; batch runs use none.
  double function_tolerance = 1e-5;
  double initial_trust_region_radius =
      1e12;                         ///< nearly undamped Gauss-Newton; one retry with 1e4 when that is not usable
  std::size_t first_free_pose = 0;  ///< poses before it are held constant, beside the graph's own
};

/// What became of a solve. Only a usable one has changed the graph.
struct Verdict {
  bool usable = false;
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0.0;  ///< ½ Σ ρ(‖r‖²)
  double final_cost = 0.0;
  double seconds = 0.0;
  std::string message;
};

/// Minimises the robust cost of all factors over poses, active landmarks and free touching points, in place,
/// warm-started from the values in `graph` (Ceres, analytic Jacobians, SPARSE_NORMAL_CHOLESKY). On an unusable outcome
/// `graph` is untouched. Without any PriorFactor pose 0 is held constant (gauge).
[[nodiscard]] Verdict optimize(Graph& graph, const OptimizerOptions& options);

/// ½ Σ ρ(‖r‖²) at the current values.
[[nodiscard]] double cost(const Graph& graph);

}  // namespace kinemap::graph
