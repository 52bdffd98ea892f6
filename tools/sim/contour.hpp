// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/sim/geometry.hpp"
#include "tools/sim/random.hpp"

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
};

struct TracingHabit {
  double speed = 0.28;      ///< m/s
  double sloppiness = 0.5;  ///< 0 careful … 1 careless: wider corners, more and higher lift-offs, shakier line
};

/// The finger's way over time: slows and pauses at corners, cuts them by up to 4 cm, trembles by some millimetres,
/// lifts off now and then.
std::vector<ContourSample> run_along(const Contour& contour, const TracingHabit& habit, double rate_hz, Random& random);

}  // namespace kinemap::sim
