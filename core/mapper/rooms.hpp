// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/map.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"
#include "core/mapper/walls.hpp"

namespace kinemap {

/// Closed rings of joined walls, counter-clockwise. Ids count from 1.
std::vector<Room> find_rooms(const MapState& state, const std::vector<FiniteWall>& walls,
                             const MapperConfig::Walls& config);

/// Where the wearer walked through a wall: one doorway for both faces of a partition and for all times.
std::vector<Doorway> find_doorways(const MapState& state, const std::vector<FiniteWall>& walls,
                                   const std::vector<Room>& rooms);

}  // namespace kinemap
