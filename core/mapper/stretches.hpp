// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/mapper/associate.hpp"
#include "core/mapper/state.hpp"
#include "core/mapper/wall_frame.hpp"

namespace kinemap {

/// A touched part of a wall: one landmark, or several that overlap in one plane.
struct Stretch {
  std::size_t landmark;  ///< of several the longest
  WallFrame frame;
  Interval touched;                    ///< along `frame`, m
  std::vector<std::size_t> landmarks;  ///< all, that one included
  std::vector<std::size_t> poses;      ///< key poses from which it was touched, ascending
  std::size_t zone = 0;                ///< stretches of different zones belong to different rooms

  [[nodiscard]] double length() const { return touched.hi - touched.lo; }
  [[nodiscard]] Eigen::Vector3d tail() const { return frame.point(touched.lo); }
  [[nodiscard]] Eigen::Vector3d head() const { return frame.point(touched.hi); }
};

/// The wearer walks through the plane of a wall.
struct Passage {
  std::size_t pose = 0;    ///< the key pose before
  Eigen::Vector2d p;       ///< where, m
  std::size_t before = 0;  ///< key pose that was clearly on the one side
  std::size_t after = 0;   ///< key pose that was clearly on the other side
};

/// Where the trajectory goes through the plane of `wall` between the coordinates `lo` and `hi` along it. It must come
/// clearly from one side to the other (0.35 m behind the wall): drift and a body that bends over the line are none.
std::vector<Passage> passages(const MapState& state, const WallFrame& wall, double lo, double hi);

/// All touched parts of walls, and for each key pose the zone in which the wearer was. People cannot walk through
/// walls: where the trajectory goes through what was touched of one there is a doorway, so what was touched before and
/// after lies in different zones, unless a wall was touched from both.
struct TouchedWalls {
  std::vector<Stretch> stretches;
  std::vector<std::size_t> zone_of_pose;
};
TouchedWalls touched_walls(const MapState& state);

}  // namespace kinemap
