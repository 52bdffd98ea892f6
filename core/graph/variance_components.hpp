// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/graph/graph.hpp"

namespace kinemap::graph {

/// How large the errors of one group of factors were against what their sigmas (times Graph::noise) promise.
struct VarianceComponent {
  double squares = 0.0;     ///< Σ r² of its whitened residuals (robust weights included) at the current values
  double redundancy = 0.0;  ///< what that sum is expected to be: its share of the graph's redundancy, n − tr(J Σ Jᵀ)
};

struct VarianceComponents {
  VarianceComponent heading;  ///< compasses, drifts, priors of scalars
  VarianceComponent contact;  ///< n counts a contact by its `share`
};

/// Variance component estimation (Helmert 1907; Förstner 1979): at the optimum, squares over redundancy is the factor
/// by which a group's variances are wrong; repeated with the new variances it converges. The traces are estimated with
/// random signs (Hutchinson 1990), the same for each call; their standard deviation is at most √(redundancy / 8).
/// nullopt when the system is singular (a variable without factors, no gauge).
std::optional<VarianceComponents> variance_components(const Graph& graph);

}  // namespace kinemap::graph
