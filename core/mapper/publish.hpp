// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/graph/marginals.hpp"
#include "core/map.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"
#include "core/mapper/walls.hpp"

namespace kinemap {

/// The landmarks of the graph as map objects, by ascending id; without `marginals` their sigmas stay 0 (unknown).
std::vector<MapObject> map_objects(const MapState& state, const std::vector<FiniteWall>& walls,
                                   const graph::Marginals* marginals, const MapperConfig& config);

}  // namespace kinemap
