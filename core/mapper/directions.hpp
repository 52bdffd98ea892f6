// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/graph/marginals.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// Most walls of a building are parallel or at right angles: they keep to one direction, which is a variable of the
/// graph. For each wall two hypotheses are compared: it keeps to the direction (its heading then differs from a
/// multiple of 90° by what the graph is uncertain of), or it is oblique and may have any heading. The wall's own factor
/// is taken out of the marginal before, so that no wall is judged by the decision made for it earlier. A wall whose
/// heading is too uncertain to tell which right angle is meant is left free.
///
/// Renews `state.graph.parallels`; true when a wall was decided otherwise than before. `marginals` belong to `state`.
bool align_walls(MapState& state, const graph::Marginals& marginals, const MapperConfig::Walls& config);

}  // namespace kinemap
