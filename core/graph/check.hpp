// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/graph/graph.hpp"

namespace kinemap::graph {

/// What makes the graph impossible to evaluate: an index out of range, a factor between a variable and itself, a sigma
/// or scale that is not positive, a number that is not finite, a contact on a landmark without a surface. nullopt when
/// there is nothing to say against it.
std::optional<std::string> find_fault(const Graph& graph);

}  // namespace kinemap::graph
