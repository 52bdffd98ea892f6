// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/graph/graph.hpp"

namespace kinemap {

/// How much better or worse this suit, wearer and room are than the configuration expects, from what the loops of an
/// optimised graph left over (variance component estimation). For what is published of uncertainty: the estimate itself
/// keeps to the expected noise, since the closures that were accepted say little of those that a narrower noise would
/// refuse.
graph::NoiseScales estimate_noise(graph::Graph graph);

/// A first estimate of the heading's part of it, from the optimum at the expected noise: 1 until loops have closed.
double heading_noise(const graph::Graph& graph);

}  // namespace kinemap
