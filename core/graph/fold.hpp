// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/graph/graph.hpp"

namespace kinemap::graph {

/// What the contacts, seats and folded factors of `part` say of each landmark together, with its poses taken as known:
/// their Gauss-Newton approximation at the graph's values, robust weights as they stand. One factor for each active
/// landmark that has any and each free touching point with which it was touched, by ascending landmark. Near these
/// values they have the cost, gradient and curvature of what they stand for. Other factors of `part` are left aside.
/// nullopt when something cannot be evaluated (see check.hpp).
std::optional<std::vector<FoldedFactor>> fold(Graph part);

}  // namespace kinemap::graph
