// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "tools/sim/habits.hpp"

namespace kinemap::sim {

/// A line that a finger is to follow: vertices joined by straight edges.
struct Contour {
  std::vector<Vec3> vertices;
  std::vector<Vec3> outward;  ///< per edge: unit, level; towards where the wearer stands
  Vec3 surface{0, 0, 1};      ///< unit normal of the surface, along which the finger lifts off
};

/// One instant on the way along a contour.
struct ContourSample {
  Vec3 p;
  Vec3 outward;
  bool lifted = false;  ///< off the surface
};

/// Room for a hand at this place? (There may be a wall beside a table's corner.)
using HandRoom = std::function<bool(const Vec3&)>;

/// The finger's way over time: slows and rests at corners, cuts or overshoots them, rests on the way, trembles, leaves
/// the surface now and then. `speed` in m/s.
std::vector<ContourSample> run_along(const Contour& contour, const Habits& habits, double speed, double rate_hz,
                                     const HandRoom& has_room, Random& random);

/// Lets the hand leave the surface (unit normal `surface`) now and then for 0.3–1 s while it goes on; never near the
/// points `keep`, which make an object's size.
void lift_off(std::vector<ContourSample>& samples, const Vec3& surface, const std::vector<Vec3>& keep,
              const Habits& habits, double rate_hz, Random& random);

}  // namespace kinemap::sim
