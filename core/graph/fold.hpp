// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/graph/graph.hpp"

namespace kinemap::graph {

/// What the contacts, seats and folded factors of `part` say of each landmark together, with its poses taken as known:
/// their Gauss-Newton approximation at the graph's values, robust weights as they stand. One factor for each active
/// landmark that has any, by ascending landmark; a landmark's contacts are of one touching point. Near these values it
/// has the cost, gradient and curvature of what it stands for. Other factors of `part` are left aside. nullopt when
/// something cannot be evaluated (see check.hpp).
std::optional<std::vector<FoldedFactor>> fold(Graph part);

}  // namespace kinemap::graph
