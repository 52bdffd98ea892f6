// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/landmarks/sides.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// Chooses anew, for each contact with a table or screen, the side that it was drawn along, from where it lies in the
/// rectangle's axes as the graph has them now: the first choice was made on raw odometry, which bends contours. The
/// contacts of one visit are judged together, so that the order of sides round the contour and the direction of travel
/// speak too; a contact keeps its side unless another one is clearly better. Contacts that are on no side, or in a
/// corner, speak of the plane only (Edge::None) until they are on one again. The end of an open contour keeps its
/// corner as long as the visit does not follow the side that the corner stands for.
///
/// Returns how many contacts changed; 0 means settled. Deterministic and cheap: linear in the number of contacts.
std::size_t reassign_edges(MapState& state, const SideCosts& costs = {});

}  // namespace kinemap
