// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/map.hpp"
#include "core/mapper/config.hpp"
#include "core/mapper/state.hpp"

namespace kinemap {

/// One end of a finite wall.
struct WallEnd {
  double s = 0.0;  ///< coordinate along the wall's WallFrame, m
  EndKind kind = EndKind::Open;
  std::optional<std::size_t> neighbour;  ///< index of the wall that comes next; an inferred one may lie in between
  double sigma_m = 0.0;                  ///< what the end adds to the uncertainty of the wall's length
};

/// A wall cut to its finite part.
struct FiniteWall {
  std::size_t landmark = 0;            ///< gives the plane: of several stretches of one wall the longest
  std::vector<std::size_t> stretches;  ///< all landmarks that make up the wall, that one included, from tail to head
  WallEnd tail;                        ///< where it begins, going counter-clockwise round its room
  WallEnd head;

  [[nodiscard]] double length() const { return head.s - tail.s; }
};

/// Cuts the infinite planes of the walls at their intersections (paper, section IV). Each wall has a head and a tail
/// (room on the left); heads are joined to tails one to one such that the walls are prolonged and shortened least in
/// sum and every closed ring is a room: counter-clockwise, without crossing itself, with the wearer in it; or,
/// clockwise and without the wearer, something that stands free in one. Walls of rooms between which the wearer walked
/// through a wall are never joined. A head only ever meets a tail, so outer corners, inner corners of L-shapes and the
/// two faces of a partition come out of the same rule. Where two parallel walls lack the one between them, it is
/// inferred from what stands in front of it; where the two faces of a partition end in one room, its end. An end that
/// meets nobody stays where the hand last touched.
std::vector<FiniteWall> cut_walls(const MapState& state, const MapperConfig::Walls& config);

}  // namespace kinemap
