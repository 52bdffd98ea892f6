// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/graph/graph.hpp"

namespace kinemap {

/// How much better or worse this suit, wearer and room are than the configuration expects: headings and contacts from
/// what the loops of an optimised graph left over (variance component estimation), and the way, of which loops show
/// little, from these, since a suit is mostly good or bad as a whole. For what is published of uncertainty: the
/// estimate itself keeps to the expected noise, since the closures that were accepted say little of those that a
/// narrower noise would refuse.
graph::NoiseScales estimate_noise(graph::Graph graph);

/// What the heading's part of it is probably (five in six) not above, from the optimum at the expected noise.
double most_heading_noise(const graph::Graph& graph);

}  // namespace kinemap
