// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/floor_space.hpp"

/// Groups of things that can be taken for each other. Each returns false when the room has no place for it.
namespace kinemap::sim {

/// Two tables of one size side by side, 10–30 cm or a metre apart.
bool add_twin_tables(Building& building, FloorSpace& space, int room, Random& random);
/// Three or four chairs in a row along a wall, 0.6–0.7 m from seat to seat.
bool add_chair_row(Building& building, FloorSpace& space, int room, Random& random);
/// Two monitors of one size side by side on one desk, which comes with them.
bool add_twin_screens(Building& building, FloorSpace& space, const Reach& reach, int room, Random& random);

}  // namespace kinemap::sim
