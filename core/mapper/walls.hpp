// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/map.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// A wall cut to its finite part: coordinates along its WallFrame, m.
struct FiniteWall {
  std::size_t landmark = 0;            ///< gives the plane: of several stretches of one wall the longest
  std::vector<std::size_t> stretches;  ///< all landmarks that make up the wall, that one included, from tail to head
  double tail = 0.0;                   ///< where it begins, going counter-clockwise round its room
  double head = 0.0;
  std::optional<std::size_t> next;  ///< index of the wall whose tail its head meets
  std::optional<std::size_t> previous;
};

/// Cuts the infinite planes of the walls at their intersections (paper, section IV). Each wall has a head and a tail
/// (room on the left); heads are joined to tails one to one such that the walls are prolonged and shortened least in
/// sum. A head only ever meets a tail, so outer corners, inner corners of L-shapes and the two faces of a partition
/// come out of the same rule. An end that meets nobody stays where the hand last touched.
std::vector<FiniteWall> cut_walls(const MapState& state, const MapperConfig::Walls& config);

/// Closed rings of joined walls, counter-clockwise. Ids count from 1.
std::vector<Room> find_rooms(const MapState& state, const std::vector<FiniteWall>& walls,
                             const MapperConfig::Walls& config);

}  // namespace kinemap
