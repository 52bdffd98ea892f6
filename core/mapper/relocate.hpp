// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/mapper/state.hpp"

namespace kinemap {

/// After a long break in odometry (the suit was started anew somewhere) place and heading are unknown: what is seen
/// then stands in a part of the map of its own until it is certain how that lies to the part before.

/// The odometry factor of the newest break over which not even the heading is known and no relocation was found yet;
/// nullopt: there is none.
std::optional<std::size_t> open_break(const graph::Graph& graph);

/// For each landmark whether it was seen after the open break; empty when there is none. What was seen before must not
/// be taken for one that was seen after by its place: there is none.
std::vector<bool> beyond_break(const MapState& state);

/// How the newest part has to be moved to lie on the map before it, by several objects at once: their kinds, sizes,
/// heights and how they stand to each other. nullopt while there is no open break, less than three things fit, or
/// another way to lay it fits nearly as well (rooms and rows of desks look alike).
std::optional<Pose> find_relocation(const MapState& state);

/// Moves the newest part, and holds it there loosely; the break is closed.
void relocate(MapState& state, const Pose& T_map_part);

}  // namespace kinemap
