// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/graph/marginals.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// What in the map cannot be, since bodies exclude each other: the wearer walked through a table, a screen or what was
/// touched of a wall; a table or wall stands in another. −2 ln of the chance that drift explains it, summed over all
/// that is found, each `most` at most, so that it is evidence and no veto. 0: nothing contradicts it.
/// `marginals`: of `state`; null: computed when there is anything to judge.
double free_space_cost(const MapState& state, const graph::Marginals* marginals, double most);

}  // namespace kinemap
